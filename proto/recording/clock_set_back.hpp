// A device's clock that is set back while recording, as the order of its samples shows. Internal to proto/.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace odomcalib {

/// One step of a clock.
struct SetBack {
  std::size_t first = 0;  ///< sample, the first after it
  double by = 0.0;        ///< s by which the stamps from there on are too early, if samples come as evenly as
                          ///< before
};

/// Where the stamps of one stream go back and then on as steadily as before: the time that is gone through
/// again is full of samples on either side of the step. Neither a sample that comes late nor a block of them
/// is that: what comes late is missing where it belongs.
/// @param stamps s, in the order of the file
std::vector<SetBack> set_back(std::span<const double> stamps);

/// The stamps with every step undone.
std::vector<double> without_steps(std::vector<double> stamps, std::span<const SetBack> steps);

}  // namespace odomcalib
