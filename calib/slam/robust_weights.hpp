// Least squares over a graph some of whose edges are far worse than they say.
#pragma once

#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

/// Settles the graph and lowers the information of edges that the others contradict, again and again: weights
/// of Cauchy's distribution, 1 / (1 + chi2 / c^2) (Huber, Robust Statistics, 1981, chapter 7). What the edges
/// hold afterwards is what they were trusted, so that settling the graph again moves nothing.
/// @return whether the graph could be settled; if not, it is as it was
bool settle_robustly(PoseGraph& graph);

}  // namespace odomcalib::calib::slam
