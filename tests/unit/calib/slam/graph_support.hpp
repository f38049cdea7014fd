// Small graphs for tests, and a dense reference that shares nothing with the sparse solver.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <string>

#include "calib/slam/edge_error.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib::calib::slam::test_support {

inline PoseGraph graph_of(const std::string& text) {
  auto graph = read_pose_graph_text(text, "test");
  return graph.ok() ? std::move(graph).value() : PoseGraph{};
}

struct WorldOptions {
  int poses = 200;
  double position_sigma = 0.02;  // m
  double heading_sigma = 0.01;   // rad
  bool anisotropic = false;      // random full covariances
  int points = 0;
  double noise = 1.0;  // of the stated sigmas
};

struct World {
  PoseGraph graph;
  Placement truth;
};

/// A robot that wanders through a town of right angles and recognises places within 1.5 m.
class WorldMaker {
 public:
  WorldMaker(const WorldOptions& options, unsigned seed) : options_(options), engine_(seed) {}

  World make() {
    wander();
    for (std::size_t i = 0; i < poses(); ++i)
      for (std::size_t j = i + 1; j < poses(); j = j == i + 1 ? j + 9 : j + 1)
        if (j == i + 1 || near(i, j)) add_edge(i, j);
    for (int p = 0; p < options_.points; ++p) add_point();
    world_.graph.vertices.front().fixed = true;
    return world_;
  }

 private:
  [[nodiscard]] std::size_t poses() const { return static_cast<std::size_t>(options_.poses); }
  double normal() { return normal_(engine_); }

  void wander() {
    math::Pose pose;
    for (int i = 0; i < options_.poses; ++i) {
      world_.truth.push_back({pose.x, pose.y, math::wrap_angle(pose.yaw)});
      world_.graph.vertices.push_back({i, VertexKind::pose, 0.0, 0.0, 0.0, false});
      const double draw = normal();
      double turn = std::abs(draw) > 1.0 ? std::copysign(math::kPi / 2.0, draw) : 0.0;
      if (std::hypot(pose.x, pose.y) > 12.0) turn = std::atan2(-pose.y, -pose.x) - pose.yaw;
      pose = compose(pose, math::Pose{1.0, 0.0, math::wrap_angle(turn)});
    }
  }

  [[nodiscard]] bool near(std::size_t i, std::size_t j) const {
    return std::hypot(world_.truth[i].x - world_.truth[j].x, world_.truth[i].y - world_.truth[j].y) < 1.5;
  }

  /// A square root of the covariance of one edge.
  Eigen::Matrix3d spread() {
    Eigen::Matrix3d L =
        Eigen::Vector3d(options_.position_sigma, options_.position_sigma, options_.heading_sigma)
            .asDiagonal();
    if (!options_.anisotropic) return L;
    for (int i = 0; i < 3; ++i) {
      L.row(i) *= std::exp(normal());
      for (int k = 0; k < i; ++k) L(i, k) = 0.5 * L(i, i) * normal();
    }
    return L;
  }

  void add_edge(std::size_t i, std::size_t j) {
    const Eigen::Matrix3d L = spread();
    const Eigen::Matrix3d information = (L * L.transpose()).inverse();
    const Eigen::Vector3d e = options_.noise * (L * Eigen::Vector3d(normal(), normal(), normal()));
    const math::Pose motion =
        compose(math::between(world_.truth[i], world_.truth[j]), inverse(math::Pose{e[0], e[1], e[2]}));
    GraphEdge edge{i, j, {motion.x, motion.y, math::wrap_angle(motion.yaw)}, {}};
    edge.information = {information(0, 0), information(0, 1), information(0, 2),
                        information(1, 1), information(1, 2), information(2, 2)};
    world_.graph.edges.push_back(edge);
  }

  void add_point() {
    const std::size_t vertex = world_.graph.vertices.size();
    const math::Pose point{8.0 * normal(), 8.0 * normal(), 0.0};
    world_.truth.push_back(point);
    world_.graph.vertices.push_back(
        {1000000 + static_cast<std::int64_t>(vertex), VertexKind::point, 0.0, 0.0, 0.0, false});
    const double weight = 1.0 / (options_.position_sigma * options_.position_sigma);
    for (std::size_t i = vertex % 7; i < poses(); i += 7) {
      const math::Pose seen = between(world_.truth[i], point);
      world_.graph.edges.push_back({i,
                                    vertex,
                                    {seen.x + options_.noise * options_.position_sigma * normal(),
                                     seen.y + options_.noise * options_.position_sigma * normal(), 0.0},
                                    {weight, 0.0, 0.0, weight, 0.0, 0.0}});
    }
  }

  WorldOptions options_;
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  World world_;
};

/// Hessian H and b of H dx = b over all vertices, three rows each.
struct DenseSystem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd b;
};

inline Eigen::Matrix3d numeric_jacobian(const GraphEdge& edge, const Placement& at, std::size_t vertex) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d jacobian;
  for (int k = 0; k < 3; ++k) {
    const auto shifted = [&](double step) {
      slam::Placement moved = at;
      (k == 0 ? moved[vertex].x : k == 1 ? moved[vertex].y : moved[vertex].yaw) += step;
      return slam::edge_error(edge, moved);
    };
    Eigen::Vector3d difference = shifted(kStep) - shifted(-kStep);
    difference[2] = math::wrap_angle(difference[2]);
    jacobian.col(k) = difference / (2.0 * kStep);
  }
  return jacobian;
}

/// @param jacobian_of (edge, placement, vertex): numeric_jacobian, or anything that was proved against it
template <typename Jacobian>
DenseSystem dense_system(const PoseGraph& graph, const Placement& at, Jacobian jacobian_of) {
  const auto rows = static_cast<Eigen::Index>(3 * at.size());
  const auto row = [](std::size_t vertex) { return static_cast<Eigen::Index>(3 * vertex); };
  DenseSystem system{Eigen::MatrixXd::Zero(rows, rows), Eigen::VectorXd::Zero(rows)};
  for (const GraphEdge& edge : graph.edges) {
    const Eigen::Matrix3d information = information_of(edge);
    const Eigen::Vector3d error = edge_error(edge, at);
    for (const std::size_t a : {edge.from, edge.to}) {
      const Eigen::Matrix3d weighted = jacobian_of(edge, at, a).transpose() * information;
      system.b.segment<3>(row(a)) -= weighted * error;
      for (const std::size_t b : {edge.from, edge.to})
        system.hessian.block<3, 3>(row(a), row(b)) += weighted * jacobian_of(edge, at, b);
    }
  }
  return system;
}

}  // namespace odomcalib::calib::slam::test_support
