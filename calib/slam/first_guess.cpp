#include "calib/slam/first_guess.hpp"

#include <complex>

#include "calib/slam/block_matrix.hpp"
#include "calib/slam/descent.hpp"

namespace odomcalib::calib::slam {
namespace {

using Complex = std::complex<double>;
using ComplexBlock = BlockMatrix<Complex>::Block;

/// Edges between poses that tell something about rotation.
std::vector<std::size_t> turning_edges(const PoseGraph& graph) {
  std::vector<std::size_t> edges;
  for (std::size_t k = 0; k < graph.edges.size(); ++k)
    if (rotation_information(graph.edges[k]) > 0.0) edges.push_back(k);
  return edges;
}

std::vector<Eigen::Index> unknown_headings(const PoseGraph& graph) {
  std::vector<Eigen::Index> sizes;
  for (const GraphVertex& vertex : graph.vertices)
    sizes.push_back(vertex.fixed || vertex.kind == VertexKind::point ? 0 : 1);
  return sizes;
}

ComplexBlock block_of(Complex number) {
  ComplexBlock block = ComplexBlock::Zero();
  block(0, 0) = number;
  return block;
}

/// The relaxation's linear system.
class HeadingSystem {
 public:
  HeadingSystem(const PoseGraph& graph, const std::vector<std::size_t>& places)
      : matrix_(unknown_headings(graph), links_of(graph), places) {
    right_side_.setZero(matrix_.rows());
  }
  void add(const GraphEdge& edge, const Placement& at) {
    const double weight = rotation_information(edge);
    const Complex turn = std::polar(1.0, edge.motion[2]);
    add_end(edge.from, weight, edge.to, std::conj(turn), at);
    add_end(edge.to, weight, edge.from, turn, at);
    if (matrix_.size(edge.from) > 0 && matrix_.size(edge.to) > 0)
      matrix_.add(matrix_.slot(edge.from, edge.to), edge.from, edge.to, block_of(-weight * std::conj(turn)));
  }
  /// Headings of unit length; where the system says nothing, those of `at`.
  Placement solve(Placement at) {
    if (matrix_.factorize(Eigen::VectorXd::Zero(matrix_.rows()))) return at;
    const auto headings = matrix_.solve(right_side_);
    for (std::size_t v = 0; v < at.size(); ++v)
      if (matrix_.size(v) > 0 && std::abs(headings[matrix_.row(v)]) > 0.0)
        at[v].yaw = std::arg(headings[matrix_.row(v)]);
    return at;
  }

 private:
  void add_end(std::size_t here, double weight, std::size_t there, Complex turn_here_from_there,
               const Placement& at) {
    if (matrix_.size(here) == 0) return;
    matrix_.add_diagonal(here, block_of(weight));
    if (matrix_.size(there) == 0)
      right_side_[matrix_.row(here)] += weight * turn_here_from_there * std::polar(1.0, at[there].yaw);
  }
  BlockMatrix<Complex> matrix_;
  BlockMatrix<Complex>::Vector right_side_;
};

Placement with_headings(const PoseGraph& graph, const std::vector<std::size_t>& places, const Placement& at) {
  HeadingSystem system(graph, places);
  for (const std::size_t k : turning_edges(graph)) system.add(graph.edges[k], at);
  return system.solve(at);
}

}  // namespace

double rotation_information(const GraphEdge& edge) {
  const auto& [xx, xy, xt, yy, yt, tt] = edge.information;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-12 * xx * yy)) return tt;
  // tt - (xt yt) [xx xy; xy yy]^-1 (xt yt)'
  return tt - (yy * xt * xt - 2.0 * xy * xt * yt + xx * yt * yt) / determinant;
}

Placement rotations_first(const PoseGraph& graph, const std::vector<std::size_t>& places,
                          const Placement& at) {
  return PositionSolver(graph, places).solve(with_headings(graph, places, at));
}

}  // namespace odomcalib::calib::slam
