// Pose graphs beside Ceres (Levenberg-Marquardt, sparse Cholesky, automatic derivatives) on the same graph in
// the same run; CPU time without reading. Graphs are those of ODOMCALIB_SHARED (data/posegraph), started from
// the values of the file, which are odometry or close to it. Arguments that are numbers add made graphs of so
// many poses.
#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <numbers>
#include <random>

#include "calib/math/se2.hpp"
#include "calib/slam/optimize.hpp"
#include "proto/recording/pose_graph.hpp"
#include "tests/shared_folder.hpp"

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

/// Motion from one vertex to another with the noise of a good scan match.
GraphEdge seen_edge(const PoseGraph& graph, std::size_t from, std::size_t to, std::mt19937_64& engine) {
  constexpr double kMetres = 0.01, kRadians = 0.005;
  std::normal_distribution<double> normal;
  const auto pose = [&graph](std::size_t k) {
    return calib::math::Pose{graph.vertices[k].x, graph.vertices[k].y, graph.vertices[k].yaw};
  };
  const auto way = calib::math::between(pose(from), pose(to));
  const double place = 1.0 / (kMetres * kMetres), turn = 1.0 / (kRadians * kRadians);
  return {from,
          to,
          {way.x + kMetres * normal(engine), way.y + kMetres * normal(engine),
           calib::math::wrap_angle(way.yaw + kRadians * normal(engine))},
          {place, 0.0, 0.0, place, 0.0, turn}};
}

/// A walk on the streets of a square town, a metre a step, that closes a loop at every corner it has seen
/// before; it starts a few decimetres off, as after a first settling.
PoseGraph town(std::size_t poses) {
  std::mt19937_64 engine(1);
  std::uniform_int_distribution<int> turn(-1, 1);
  const int half = static_cast<int>(std::sqrt(static_cast<double>(poses)) / 3.0) + 2;
  PoseGraph graph;
  std::map<std::pair<int, int>, std::size_t> last_at;
  int x = 0, y = 0, heading = 0;
  for (std::size_t k = 0; k < poses; ++k) {
    graph.vertices.push_back({static_cast<std::int64_t>(k), VertexKind::pose, static_cast<double>(x),
                              static_cast<double>(y),
                              calib::math::wrap_angle(0.5 * std::numbers::pi * heading), k == 0});
    if (k > 0) graph.edges.push_back(seen_edge(graph, k - 1, k, engine));
    const auto before = last_at.find({x, y});
    if (before != last_at.end() && before->second + 10 < k)
      graph.edges.push_back(seen_edge(graph, before->second, k, engine));
    last_at[{x, y}] = k;
    int step_x = 0, step_y = 0;
    do {
      if (x % 5 == 0 && y % 5 == 0) heading = (heading + turn(engine) + 4) % 4;
      if (std::abs(x) >= 5 * half || std::abs(y) >= 5 * half) heading = (heading + 2) % 4;
      step_x = heading == 0 ? 1 : heading == 2 ? -1 : 0;
      step_y = heading == 1 ? 1 : heading == 3 ? -1 : 0;
    } while (std::abs(x + step_x) > 5 * half || std::abs(y + step_y) > 5 * half);
    x += step_x;
    y += step_y;
  }
  std::normal_distribution<double> normal;
  for (std::size_t k = 1; k < poses; ++k) {
    graph.vertices[k].x += 0.1 * normal(engine);
    graph.vertices[k].y += 0.1 * normal(engine);
    graph.vertices[k].yaw += 0.05 * normal(engine);
  }
  return graph;
}

void register_graph(const std::string& name, const std::shared_ptr<PoseGraph>& graph) {
  if (graph->vertices.empty()) return;
  const auto add = [&name](const std::string& solver, auto body) {
    benchmark::RegisterBenchmark((name + "/" + solver).c_str(), body)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime();
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

/// The public graphs, where they are.
void register_public_graphs() {
  const auto folder = odomcalib::shared_folder("data") / "posegraph";
  if (!std::filesystem::is_directory(folder)) {
    std::cerr << "REAL DATA ABSENT: " << folder << " not found; set ODOMCALIB_SHARED\n";
    return;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().filename().string().ends_with(".g2o.gz")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& file : files)
    odomcalib::register_graph(file.filename().string(),
                              std::make_shared<odomcalib::PoseGraph>(odomcalib::read(file)));
}

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  register_public_graphs();
  for (int k = 1; k < argc; ++k)
    odomcalib::register_graph("town" + std::string(argv[k]),
                              std::make_shared<odomcalib::PoseGraph>(odomcalib::town(std::stoul(argv[k]))));
  benchmark::RunSpecifiedBenchmarks();
}
