// A clock that is set while recording: from one moment on, the reference is late or early by something else.
#pragma once

#include "calib/measurement/dataset.hpp"

namespace odomcalib::calib::estimation {

struct ClockStep {
  double moment = 0.0;  ///< s, on the clock of the reference: the first sample after it
  double size = 0.0;    ///< s, by which stamps of the reference step ahead against those of the counts
};

/// The moment from which a delay of its own explains the measured rotation plainly better than one delay, and
/// than a delay that grows steadily, explain all of it; nothing where neither holds, or where either side
/// turns too little to know its delay. Two segments, by exhaustive search (Killick et al., JASA 2012, with
/// one change point).
/// @param one measured roughly
std::optional<ClockStep> clock_step(const measurement::FitData& one);

/// The data measured again with the stamps of the reference put on one clock, and said so in the recording's
/// `repairs`; without such a step the data given.
/// @param rough measured roughly
measurement::Dataset without_clock_steps(measurement::Dataset rough);

}  // namespace odomcalib::calib::estimation
