// Pose graphs beside Ceres (Levenberg-Marquardt, sparse Cholesky, automatic derivatives) on the same graph in
// the same run; CPU time without reading. Graphs are those of ODOMCALIB_SHARED (data/posegraph), started from
// the values of the file, which are odometry or close to it.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <filesystem>
#include <iostream>
#include <numbers>

#include "calib/slam/optimize.hpp"
#include "proto/recording/pose_graph.hpp"

namespace odomcalib {
namespace {

PoseGraph read(const std::filesystem::path& path) {
  const std::vector<std::filesystem::path> files{path};
  auto graph = read_pose_graph(files);
  if (!graph) {
    std::cerr << graph.error().text() << '\n';
    return {};
  }
  calib::slam::fix_first_pose(graph.value());
  return std::move(graph).value();
}

/// The error of one edge, written anew so that the two solvers share no formula; white through a root of the
/// information.
struct Residual {
  explicit Residual(const GraphEdge& of) : edge(of) {
    const auto& [xx, xy, xt, yy, yt, tt] = of.information;
    Eigen::Matrix3d information;
    information << xx, xy, xt, xy, yy, yt, xt, yt, tt;
    root = information.llt().matrixU();
  }
  template <typename T>
  bool operator()(const T* from, const T* to, T* out) const {
    const Eigen::Matrix<T, 2, 1> apart(to[0] - from[0], to[1] - from[1]);
    const Eigen::Matrix<T, 2, 1> seen = Eigen::Rotation2D<T>(-from[2]) * apart;
    const Eigen::Matrix<T, 2, 1> lacking(seen[0] - edge.motion[0], seen[1] - edge.motion[1]);
    const Eigen::Matrix<T, 2, 1> in_frame = Eigen::Rotation2D<T>(T(-edge.motion[2])) * lacking;
    const T turn = to[2] - from[2] - edge.motion[2];
    const T wrapped =
        turn - 2.0 * std::numbers::pi * ceres::floor((turn + std::numbers::pi) / (2.0 * std::numbers::pi));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> white(out);
    white = root.cast<T>() * Eigen::Matrix<T, 3, 1>(in_frame[0], in_frame[1], wrapped);
    return true;
  }
  GraphEdge edge;
  Eigen::Matrix3d root;
};

ceres::Solver::Summary solve_with_ceres(const PoseGraph& graph) {
  std::vector<std::array<double, 3>> poses;
  for (const GraphVertex& vertex : graph.vertices) poses.push_back({vertex.x, vertex.y, vertex.yaw});
  ceres::Problem problem;
  for (const GraphEdge& edge : graph.edges)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 3, 3, 3>(new Residual(edge)), nullptr,
                             poses[edge.from].data(), poses[edge.to].data());
  problem.SetParameterBlockConstant(poses[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

void with_ceres(benchmark::State& state, const PoseGraph& graph) {
  for (auto _ : state) {
    const auto summary = solve_with_ceres(graph);
    state.counters["chi2"] = 2.0 * summary.final_cost;
    state.counters["iterations"] = summary.num_successful_steps + summary.num_unsuccessful_steps;
  }
}

void with_odomcalib(benchmark::State& state, const PoseGraph& graph, calib::slam::GraphStart start) {
  for (auto _ : state) {
    PoseGraph copy = graph;
    const auto summary = calib::slam::optimize_graph(copy, {.start = start});
    state.counters["chi2"] = summary.chi2_after;
    state.counters["iterations"] = static_cast<double>(summary.iterations.size());
  }
}

void register_graph(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  auto graph = std::make_shared<PoseGraph>(read(path));
  if (graph->vertices.empty()) return;
  const auto add = [&name](const std::string& solver, auto body) {
    benchmark::RegisterBenchmark((name + "/" + solver).c_str(), body)->Unit(benchmark::kMillisecond);
  };
  add("ceres", [graph](benchmark::State& state) { with_ceres(state, *graph); });
  add("odomcalib", [graph](benchmark::State& state) {
    with_odomcalib(state, *graph, calib::slam::GraphStart::automatic);
  });
  add("odomcalib_from_file",
      [graph](benchmark::State& state) { with_odomcalib(state, *graph, calib::slam::GraphStart::file); });
  add("odomcalib_from_tree",
      [graph](benchmark::State& state) { with_odomcalib(state, *graph, calib::slam::GraphStart::tree); });
}

}  // namespace
}  // namespace odomcalib

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  const char* shared = std::getenv("ODOMCALIB_SHARED");
  const auto folder = std::filesystem::path(shared != nullptr ? shared : "../shared") / "data" / "posegraph";
  if (!std::filesystem::is_directory(folder)) {
    std::cerr << "REAL DATA ABSENT: " << folder << " not found; set ODOMCALIB_SHARED\n";
    return 1;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().ends_with(".g2o.gz")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) odomcalib::register_graph(file);
  benchmark::RunSpecifiedBenchmarks();
}
