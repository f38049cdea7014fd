#include "daemon/cli/output.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::cli {
namespace {

/// 0: it does not say.
std::size_t terminal_columns(int terminal) {
  winsize size{};
  return ioctl(terminal, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

/// 0: there is none.
std::size_t wanted_columns() {
  const char* told = std::getenv("COLUMNS");  // NOLINT(concurrency-mt-unsafe): nobody sets it here
  return number_from<std::size_t>(told == nullptr ? "" : told).value_or(0);
}

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

/// Takes back the line that is shown: a command to the terminal, and the only one.
void erase_line() {
  std::cerr << std::flush;
  constexpr std::string_view kErase = "\r\x1b[K";
  (void)!write(STDERR_FILENO, kErase.data(), kErase.size());
}

/// JSON without control characters: it has escapes for all of them, and its values stay what they are.
std::string dumped(const nlohmann::ordered_json& value, int indent) {
  const std::string text = value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const unsigned next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
    if (byte == 0x7F) {
      out += "\\u007f";
    } else if (byte == 0xC2 && next < 0xA0) {
      out += fmt::format("\\u{:04x}", next);
      ++i;
    } else {
      out += text[i];
    }
  }
  return out;
}

/// Columns by COLUMNS, else of the terminal, else settings::kTextColumns.
std::size_t columns_for(int terminal) {
  std::size_t columns = wanted_columns();
  if (columns == 0) columns = terminal_columns(terminal);
  return columns == 0 ? settings::kTextColumns : std::max(columns, settings::kFewestColumns);
}

/// Whole on one line in a pipe or a file, where programs look for it; within the columns of a terminal.
void print_message(const std::string& text) {
  std::cerr << wrapped_message(text, isatty(STDERR_FILENO) == 1 ? columns_for(STDERR_FILENO) : kAnyWidth);
}

std::string duration_text(double time) {
  return time < 90.0 ? fmt::format("{:.0f} s", time) : fmt::format("{:.0f} min", time / 60.0);
}

}  // namespace

VisibleStreams::VisibleStreams()
    : out_(std::cout.rdbuf()), err_(std::cerr.rdbuf()), visible_out_(*out_), visible_err_(*err_) {
  std::cout.rdbuf(&visible_out_);
  std::cerr.rdbuf(&visible_err_);
}

VisibleStreams::~VisibleStreams() {
  std::cout.rdbuf(out_);
  std::cerr.rdbuf(err_);
}

void print_json(const std::string& text, JsonMode mode) {
  const auto value = nlohmann::ordered_json::parse(text, nullptr, false);
  if (value.is_discarded()) throw std::runtime_error("the result is no JSON: " + text.substr(0, 80));
  const int indent = mode == JsonMode::pretty ? 2 : -1;
  std::cout << dumped(value, indent) << '\n';
}

void print_document(const std::string& name, const nlohmann::ordered_json& body, JsonMode mode) {
  nlohmann::ordered_json document = {{"format", "odomcalib-" + name + "/1"}};
  document.update(body);
  print_json(document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), mode);
}

int report_error(const Error& error, JsonMode mode) {
  print_message("odomcalibctl: " + error.text());
  print_error_json(error, mode);
  return exit_status(error.code);
}

nlohmann::ordered_json to_json(const Error& error) {
  return {{"code", code_name(error.code)},
          {"what", error.what},
          {"where", error.where},
          {"remedy", error.remedy}};
}

void print_error_json(const Error& error, JsonMode mode) {
  if (mode == JsonMode::off) return;
  print_document("error", {{"error", to_json(error)}}, mode);
}

void tell(const std::string& text) { print_message(text); }

void warn(const std::string& text) { print_message("odomcalibctl: warning: " + text); }

int after_flush(int status) {
  std::cout.flush();
  if (std::cout) return status;
  std::cerr << "odomcalibctl: standard output: cannot write; the result is incomplete or lost\n";
  return status == kDone ? static_cast<int>(kFailure) : status;
}

std::size_t text_columns() { return columns_for(STDOUT_FILENO); }

void print_text(const Document& document, bool legend) {
  std::cout << to_text(document, legend, text_columns());
}

void print_line(const std::string& text) { std::cout << wrapped(text, text_columns()); }

ProgressLine::ProgressLine()
    : terminal_(isatty(STDERR_FILENO) == 1),
      next_plain_(begun_ + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(settings::kQuiet_s))) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const std::string& text) { terminal_ ? replace(text) : add_plain(text); }

void ProgressLine::show(const std::string& step, double fraction) {
  const auto now = Clock::now();
  if (step != step_ || fraction < fraction_) {
    step_ = step;
    step_begun_ = now;
    step_from_ = fraction;
  }
  fraction_ = fraction;
  std::string text = fmt::format("{} {:3.0f} %", step, 100.0 * fraction);
  const double done = fraction - step_from_, taken = seconds(now - step_begun_);
  if (done >= settings::kKnownAfterShare && taken >= settings::kKnownAfter_s)
    text += ", " + duration_text(taken * (1.0 - fraction) / done) + " left of it";
  if (seconds(now - begun_) >= settings::kQuiet_s)
    text += "; " + duration_text(seconds(now - begun_)) + " so far";
  show(text);
}

/// A line that is longer than the terminal is wide would not replace itself.
void ProgressLine::replace(const std::string& text) {
  // A terminal that takes nothing now (Ctrl-S, a slow line) must not hold up whoever keeps a motion alive.
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (poll(&terminal, 1, 0) != 1 || (terminal.revents & POLLOUT) == 0) return;
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  erase_line();
  std::cerr << (columns > 1 ? text.substr(0, columns - 1) : text) << std::flush;
  shown_ = true;
}

/// A pipe that nobody reads must not hold anybody up either.
void ProgressLine::add_plain(const std::string& text) {
  const auto now = Clock::now();
  pollfd pipe{STDERR_FILENO, POLLOUT, 0};
  if (now < next_plain_ || poll(&pipe, 1, 0) != 1 || (pipe.revents & POLLOUT) == 0) return;
  std::cerr << text << std::endl;
  next_plain_ = now + std::chrono::duration_cast<Clock::duration>(
                          std::chrono::duration<double>(settings::kPlainLine_s));
}

void ProgressLine::clear() {
  if (shown_) erase_line();
  shown_ = false;
}

Meanwhile::Meanwhile(std::string what) : what_(std::move(what)), thread_([this] { run(); }) {}

Meanwhile::~Meanwhile() {
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void Meanwhile::run() {
  ProgressLine line;
  const auto begun = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!ended_.wait_for(lock, settings::kTick, [this] { return end_; })) {
    const double taken = seconds(std::chrono::steady_clock::now() - begun);
    if (taken >= settings::kQuiet_s) line.show(what_ + ", " + duration_text(taken) + " so far");
  }
}

}  // namespace odomcalib::cli
