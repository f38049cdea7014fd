#include "daemon/cli/numbers.hpp"

#include <fmt/format.h>

#include <cmath>

namespace odomcalib::cli {

CLI::Validator finite(double least, double most) {
  const bool bounded = least > std::numeric_limits<double>::lowest();
  const std::string wanted = bounded ? fmt::format("a number from {} to {}", least, most) : "a finite number";
  const auto problem = [=](std::string& text) {
    double value = 0.0;
    const bool good =
        CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= least && value <= most;
    return good ? std::string() : fmt::format("\"{}\" is not {}", text, wanted);
  };
  return {problem, bounded ? fmt::format("in [{} - {}]", least, most) : ""};
}

}  // namespace odomcalib::cli
