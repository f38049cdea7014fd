#include "daemon/cli/exit_codes.hpp"

#include <fmt/format.h>

#include <array>

namespace odomcalib::cli {
namespace {

struct Row {
  ErrorCode code;
  const char* name;
  ExitStatus status;
};

constexpr std::array kRows = {
    Row{ErrorCode::usage, "usage", kUsage},
    Row{ErrorCode::io, "io", kFailure},
    Row{ErrorCode::format, "format", kFailure},
    Row{ErrorCode::missing_units, "missing_units", kFailure},
    Row{ErrorCode::empty, "empty", kFailure},
    Row{ErrorCode::refused, "refused", kRefused},
    Row{ErrorCode::cancelled, "cancelled", kCancelled},
    Row{ErrorCode::protective_stop, "protective_stop", kProtectiveStop},
    Row{ErrorCode::device, "device", kDevice},
    Row{ErrorCode::timeout, "timeout", kTimedOut},
    Row{ErrorCode::write_failed, "write_failed", kWriteFailed},
    Row{ErrorCode::write_unknown, "write_unknown", kWriteUnknown},
    Row{ErrorCode::not_running, "not_running", kNotRunning},
    Row{ErrorCode::not_permitted, "not_permitted", kNotPermitted},
    Row{ErrorCode::busy, "busy", kBusy},
};

struct Meaning {
  ExitStatus status;
  const char* text;
};

constexpr std::array kMeanings = {
    Meaning{kDone, "done"},
    Meaning{kFailure, "failure (file, format, missing or no usable data)"},
    Meaning{kUsage, "usage: the command line makes no sense"},
    Meaning{kRefused, "refused by a quality gate, nothing was written to the controller"},
    Meaning{kCancelled, "cancelled by the user, or the connection that keeps the robot moving was lost"},
    Meaning{kProtectiveStop, "protective stop"},
    Meaning{kDevice, "device or bus failure"},
    Meaning{kWriteFailed, "write failed, old values are in force"},
    Meaning{kWriteUnknown, "state of the controller's values unknown, operator needed"},
    Meaning{kNotRunning, "the daemon is not running"},
    Meaning{kTimedOut, "timed out"},
    Meaning{kNotPermitted, "not permitted"},
    Meaning{kBusy, "busy: another motion, recording, solve or write-back runs"},
};

}  // namespace

ExitStatus exit_status(ErrorCode code) {
  for (const Row& row : kRows)
    if (row.code == code) return row.status;
  return kFailure;
}

std::string code_name(ErrorCode code) {
  for (const Row& row : kRows)
    if (row.code == code) return row.name;
  return "unknown";
}

std::string exit_status_help() {
  std::string text = "Exit status:\n";
  for (const Meaning& meaning : kMeanings)
    text += fmt::format("  {:>2}  {}\n", static_cast<int>(meaning.status), meaning.text);
  return text;
}

}  // namespace odomcalib::cli
