// What a user is told of stamps that were not believed.
#pragma once

#include <string>
#include <vector>

namespace odomcalib::calib {

/// Of stamps that were replaced by even ones, s, the largest of all recordings; zero where those given are
/// right.
struct StampJitter {
  double ticks = 0.0;
  double scans = 0.0;
  [[nodiscard]] bool any() const { return ticks > 0.0 || scans > 0.0; }
};

/// {"ticks", "scans"}, s
std::string to_json(const StampJitter& jitter);

/// A sentence for each that is worth a look at the driver.
std::vector<std::string> remarks_on(const StampJitter& jitter);

}  // namespace odomcalib::calib
