// Content of a pose graph, for people who were handed one.
#pragma once

#include <cstddef>
#include <vector>

#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam {

struct WorstEdge {
  std::size_t edge = 0;  ///< position in PoseGraph::edges
  double chi2 = 0.0;     ///< its share
};

struct GraphInfo {
  std::size_t poses = 0;
  std::size_t points = 0;
  std::size_t pose_edges = 0;
  std::size_t point_edges = 0;
  std::size_t fixed = 0;
  std::size_t parts = 0;               ///< connected; edges with zero information connect nothing
  std::size_t loops = 0;               ///< edges beyond those that a spanning tree needs
  double path_length = 0.0;            ///< m, over the edges between poses of neighbouring ids
  double chi2 = 0.0;                   ///< at the vertices as they are
  std::size_t turned_loops = 0;        ///< loops with a whole turn too much: a false minimum
  std::vector<WorstEdge> worst_edges;  ///< up to five, by their share of chi2
};

GraphInfo inspect_graph(const PoseGraph& graph);

/// An edge between poses whose ids follow each other: odometry. The others close loops.
/// @return one entry per edge
std::vector<bool> odometry_edges(const PoseGraph& graph);

}  // namespace odomcalib::calib::slam
