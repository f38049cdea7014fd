// What verbs print, and where: results on standard output, everything else on standard error.
#pragma once

#include <string>

#include "proto/result.hpp"

namespace odomcalib::cli {

enum class JsonMode { off, pretty, shortened };

/// Prints JSON text (any layout) in the wanted layout; members keep their order.
void print_json(const std::string& text, JsonMode mode);

/// One line for people on standard error, with --json also an object {"error":{...}} on standard output.
/// @return the exit status that belongs to the error
int report_error(const Error& error, JsonMode mode);

/// A line that replaces itself on a terminal; silent where standard error is none.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const std::string& text);
  void clear();

 private:
  bool terminal_;
  bool shown_ = false;
};

}  // namespace odomcalib::cli
