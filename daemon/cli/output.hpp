// What verbs print, and where: results on standard output, everything else on standard error.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "proto/result.hpp"

namespace odomcalib::cli {

enum class JsonMode { off, pretty, shortened };

/// Prints JSON text (any layout) in the wanted layout; members keep their order. Throws std::runtime_error
/// on other text: what is printed here is JSON, or nothing.
void print_json(const std::string& text, JsonMode mode);

/// Prints an object of ours with its format, "odomcalib-NAME/1", as the first member. docs/schema/NAME-1.json
/// says what else is in it: members are only ever added to a version.
void print_document(const std::string& name, const nlohmann::ordered_json& body, JsonMode mode);

/// One line for people on standard error, with --json also the document "error" on standard output.
/// @return the exit status that belongs to the error
int report_error(const Error& error, JsonMode mode);

/// Code, what, where and remedy, as the document "error" and reports have them.
nlohmann::ordered_json to_json(const Error& error);

/// The object alone, for errors whose text is printed already.
void print_error_json(const Error& error, JsonMode mode);

/// One line on standard error that is no warning.
void tell(const std::string& text);

/// One line on standard error; the verb goes on.
void warn(const std::string& text);

/// What was printed must have arrived (a full disk, a closed pipe). Call once, at the very end.
/// @return `status`, or failure where it would have been success
int after_flush(int status);

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
