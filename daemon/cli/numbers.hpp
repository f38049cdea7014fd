// Numbers on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>

namespace odomcalib::cli {

/// Takes finite numbers from `least` to `most`. CLI::Range lets NaN pass, and NaN becomes null in JSON.
CLI::Validator finite(double least = std::numeric_limits<double>::lowest(),
                      double most = std::numeric_limits<double>::max());

}  // namespace odomcalib::cli
