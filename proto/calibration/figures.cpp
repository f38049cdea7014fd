#include "proto/calibration/figures.hpp"

#include "proto/calibration/field_list.hpp"

namespace odomcalib {

std::vector<LabelledFigure> labelled_figures(const Calibration& calibration) {
  return fields::labelled(fields::additions(), calibration);
}

}  // namespace odomcalib
