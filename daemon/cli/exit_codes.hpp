// One table from failures to exit statuses (odomcalibctl(1), "EXIT STATUS").
#pragma once

#include <string>

#include "proto/result.hpp"

namespace odomcalib::cli {

enum ExitStatus : int {
  kDone = 0,
  kFailure = 1,
  kUsage = 2,
  kRefused = 3,
  kCancelled = 4,
  kProtectiveStop = 5,
  kDevice = 6,
  kWriteFailed = 7,
  kWriteUnknown = 8,
  kNotRunning = 9,
  kTimedOut = 10,
  kNotPermitted = 11,
  kBusy = 12,
};

ExitStatus exit_status(ErrorCode code);
/// The table for --help.
std::string exit_status_help();
/// "not_running" and so on, as in the enumeration.
std::string code_name(ErrorCode code);

}  // namespace odomcalib::cli
