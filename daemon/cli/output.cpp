#include "daemon/cli/output.hpp"

#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "daemon/cli/exit_codes.hpp"

namespace odomcalib::cli {

void print_json(const std::string& text, JsonMode mode) {
  const auto value = nlohmann::ordered_json::parse(text, nullptr, false);
  if (value.is_discarded()) throw std::runtime_error("the result is no JSON: " + text.substr(0, 80));
  const int indent = mode == JsonMode::pretty ? 2 : -1;
  std::cout << value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

void print_document(const std::string& name, const nlohmann::ordered_json& body, JsonMode mode) {
  nlohmann::ordered_json document = {{"format", "odomcalib-" + name + "/1"}};
  document.update(body);
  print_json(document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), mode);
}

int report_error(const Error& error, JsonMode mode) {
  std::cerr << "odomcalibctl: " << error.text() << '\n';
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

void tell(const std::string& text) { std::cerr << text << '\n'; }

void warn(const std::string& text) { std::cerr << "odomcalibctl: warning: " << text << '\n'; }

int after_flush(int status) {
  std::cout.flush();
  if (std::cout) return status;
  std::cerr << "odomcalibctl: standard output: cannot write; the result is incomplete or lost\n";
  return status == kDone ? static_cast<int>(kFailure) : status;
}

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}
ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const std::string& text) {
  // A terminal that takes nothing now (Ctrl-S, a slow line) must not hold up whoever keeps a motion alive.
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (!terminal_ || poll(&terminal, 1, 0) != 1 || (terminal.revents & POLLOUT) == 0) return;
  std::cerr << "\r\x1b[K" << text << std::flush;
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) std::cerr << "\r\x1b[K" << std::flush;
  shown_ = false;
}

}  // namespace odomcalib::cli
