// Where to begin. The error of a pose graph is linear once the headings are known, and has false minima only
// because of them: a good first guess of the headings is worth more than any solver.
#pragma once

#include "calib/slam/connectivity.hpp"
#include "calib/slam/edge_error.hpp"

namespace odomcalib::calib::slam {

/// Headings from all edges at once, by chordal relaxation (Carlone et al. 2015, "Initialization techniques
/// for 3D SLAM", sec. III-B): with headings as unit complex numbers z and w the information about rotation,
/// sum w |z_to - exp(i yaw_Z) z_from|^2 is quadratic; its minimum is found by one linear solve and scaled
/// back to unit length. Then positions for these headings, again by one linear solve.
/// Needs a fixed pose in every part, and poses that are connected without points in between; poses that are
/// not keep the heading of `at`.
/// @param places order of elimination
Placement rotations_first(const PoseGraph& graph, const std::vector<std::size_t>& places,
                          const Placement& at);

/// Information of an edge about rotation when its translation is unknown: Schur complement, [1/rad^2].
double rotation_information(const GraphEdge& edge);

}  // namespace odomcalib::calib::slam
