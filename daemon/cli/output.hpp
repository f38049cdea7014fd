// Output of verbs: results on standard output, everything else on standard error.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>

#include "daemon/cli/document.hpp"
#include "proto/result.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib::cli {

enum class JsonMode { off, pretty, shortened };

/// While it lives, standard output and standard error take visible() text alone: nothing that a file says
/// reaches the terminal as a command. Verbs print through the streams and through nothing else.
class VisibleStreams {
 public:
  VisibleStreams();
  ~VisibleStreams();
  VisibleStreams(const VisibleStreams&) = delete;
  VisibleStreams& operator=(const VisibleStreams&) = delete;

 private:
  std::streambuf *out_, *err_;  // as they were
  VisibleText visible_out_, visible_err_;
};

/// Prints JSON text (any layout) in the wanted layout; members keep their order. Throws std::runtime_error
/// on other text: what is printed here is JSON, or nothing.
void print_json(const std::string& text, JsonMode mode);

/// Prints an object of ours with its format, "odomcalib-NAME/1", as the first member. docs/schema/NAME-1.json
/// says what else is in it: members are only ever added to a version.
void print_document(const std::string& name, const nlohmann::ordered_json& body, JsonMode mode);

/// For people on standard error, one line where that is no terminal, with --json also the document "error" on
/// standard output.
/// @return the exit status that belongs to the error
int report_error(const Error& error, JsonMode mode);

/// Code, what, where and remedy, as the document "error" and reports have them.
nlohmann::ordered_json to_json(const Error& error);

/// The object alone, for errors whose text is printed already.
void print_error_json(const Error& error, JsonMode mode);

/// Columns of standard output: what COLUMNS says, or the terminal, or settings::kTextColumns.
std::size_t text_columns();

/// On standard output, within its columns.
void print_text(const Document& document, bool legend);

/// A sentence, or one line of a list, on standard output within its columns.
void print_line(const std::string& text);

/// A message on standard error that is no warning.
void tell(const std::string& text);

/// A message on standard error; the verb goes on.
void warn(const std::string& text);

/// Printed text must have arrived (a full disk, a closed pipe). Call once, at the very end.
/// @return `status`, or failure where it would have been success
int after_flush(int status);

/// How far something is that takes its time, on standard error: on a terminal a line that replaces itself,
/// else a plain line now and then, none of what ends soon.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(const std::string& text);
  /// With what is left of the step that has this name, once that can be told.
  /// @param fraction of the step, 0 to 1
  void show(const std::string& step, double fraction);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void replace(const std::string& text);
  void add_plain(const std::string& text);

  bool terminal_;
  bool shown_ = false;
  Clock::time_point begun_ = Clock::now(), step_begun_ = begun_, next_plain_;
  std::string step_;
  double step_from_ = 0.0, fraction_ = 0.0;  // of the step, when it was first heard of, and now
};

/// Shows for how long something has been going on that does not say how far it is.
class Meanwhile {
 public:
  explicit Meanwhile(std::string what);
  ~Meanwhile();
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

 private:
  void run();

  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace odomcalib::cli
