// Numbers of the calibration file that a report shows by what the list of fields says of them alone.
#pragma once

#include <string>
#include <vector>

namespace odomcalib {

struct Calibration;

struct LabelledFigure {
  std::string label;
  double value = 0.0;
  std::string unit;  ///< SI
};

/// The numbers that have a label in the list and a value in this calibration, in the order of the list.
std::vector<LabelledFigure> labelled_figures(const Calibration& calibration);

}  // namespace odomcalib
