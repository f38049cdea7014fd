// What is reported of stamps that were not believed.
#pragma once

#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::ingest {

/// Times that were replaced, the largest of all recordings, s; zero where those given are right.
struct StampReport {
  double ticks = 0.0;  ///< jitter of stamps that were evened out
  double scans = 0.0;
  double sweep = 0.0;          ///< between beams of scans that did not say so
  double turn = 0.0;           ///< s, of the head then; negative clockwise
  double sweep_p_value = 1.0;  ///< of scans taken for instants after all
  /// s, standard deviation between the recordings, of clocks that were aligned.
  double clocks = 0.0;
  [[nodiscard]] bool any() const { return ticks > 0.0 || scans > 0.0 || sweep > 0.0 || clocks > 0.0; }
};

/// {"ticks", "scans", "time_increment"}, and "clocks" where they differ, s
std::string to_json(const StampReport& report);

/// A sentence for each that is worth a look at the driver.
std::vector<std::string> remarks_on(const StampReport& report);

/// Scans that are used as instants although their head turns are bent: the effect that bears the name of what
/// was put right, with c the time of a turn over 2 pi.
std::vector<EffectResult> effects_of(const StampReport& report);

}  // namespace odomcalib::calib::ingest
