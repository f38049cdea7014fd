// Pose graphs: optimise one, tell what it holds, or make one of a recording.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/graph_picture.hpp"
#include "daemon/cli/graph_run.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct OptimizeOptions {
  std::vector<std::string> files;
  std::string out, picture;
  double unpack_limit = 0.0;  // MiB; 0: see UnpackLimit
  calib::slam::GraphOptions solver;
};

Result<PoseGraph> read_files(const OptimizeOptions& options) {
  const std::vector<std::filesystem::path> paths(options.files.begin(), options.files.end());
  const Meanwhile shown("reading " + options.files.front());
  return read_pose_graph(paths, unpack_limit_of(options.unpack_limit));
}

struct BuildOptions {
  std::string recording, out, picture;
  RecordingOptions reading;
  calib::slam::ScanGraphOptions graph;
};

template <typename... Described>
void print_graph(const Session& session, const std::string& document, const Described&... described) {
  if (session.json == JsonMode::off)
    print_text(describe(described...), session.legend);
  else
    print_document(document, to_json(described...), session.json);
}

Result<void> write_graph(const OptimizeOptions& options, const GraphRun& run) {
  if (!options.out.empty())
    if (auto written = write_output(options.out, to_g2o(run.after)); !written) return written;
  if (!options.picture.empty()) return write_output(options.picture, graph_picture(run.before, run.after));
  return {};
}

int optimize(const OptimizeOptions& options, const Session& session) {
  if (const auto files = check_outputs({{"--out", options.out}, {"--svg", options.picture}},
                                       named("the graph", options.files));
      !files)
    return report_error(files.error(), session.json);
  auto graph = read_files(options);
  if (!graph) return report_error(graph.error(), session.json);
  ProgressLine line;
  std::size_t steps = 0;
  const GraphRun run = run_graph(std::move(graph).value(), options.solver, [&](const auto& step) {
    line.show(fmt::format("optimizing: iteration {}, chi2 {:.6g}", ++steps, step.chi2));
  });
  line.clear();
  if (!run.summary.is_usable())
    return report_error({ErrorCode::refused, state_name(run.summary.state) + ": " + run.summary.reason,
                         options.files.front(), "nothing was written"},
                        session.json);
  if (auto written = write_graph(options, run); !written) return report_error(written.error(), session.json);
  print_graph(session, "graph-optimize", run);
  return kDone;
}

int describe_graph(const OptimizeOptions& options, const Session& session) {
  auto graph = read_files(options);
  if (!graph) return report_error(graph.error(), session.json);
  if (!graph.value().has_positions) {
    PoseGraph anchored = graph.value();
    calib::slam::fix_first_pose(anchored);
    calib::slam::place_along_odometry(anchored);
    for (std::size_t v = 0; v < anchored.vertices.size(); ++v)
      anchored.vertices[v].fixed = graph.value().vertices[v].fixed;
    graph = std::move(anchored);
  }
  print_graph(session, "graph-info", graph.value(), calib::slam::inspect_graph(graph.value()));
  return kDone;
}

Result<void> write_graph(const BuildOptions& options, const calib::slam::RecordingMap& map) {
  if (!options.out.empty())
    if (auto written = write_output(options.out, to_g2o(map.made.graph)); !written) return written;
  if (options.picture.empty()) return {};
  return write_output(options.picture, graph_picture(map.by_odometry, map.made.graph,
                                                     {map.occupied, map.cell, map.last_scan}));
}

int build(const BuildOptions& options, const Session& session) {
  if (const auto files =
          check_outputs({{"--out", options.out}, {"--svg", options.picture}},
                        {{"the recording", options.recording}, {"--robot", options.reading.robot_file}});
      !files)
    return report_error(files.error(), session.json);
  const auto recordings = read_recordings({options.recording}, options.reading, Intensities::left_out);
  if (!recordings) return report_error(recordings.error(), session.json);
  const auto map = [&] {
    const Meanwhile shown("matching scans and closing loops");
    return calib::slam::map_recording(recordings.value().front(), options.graph);
  }();
  if (!map) return report_error(map.error(), session.json);
  if (auto written = write_graph(options, map.value()); !written)
    return report_error(written.error(), session.json);
  print_graph(session, "graph-build", map.value());
  return kDone;
}

/// One of the names, and no other: CLI::CheckedTransformer takes and shows the numbers behind them too.
template <typename Choice>
void add_choice(CLI::App& verb, const std::string& option, Choice& chosen,
                const std::map<std::string, Choice>& choices, const std::string& help) {
  std::vector<std::string> names;
  names.reserve(choices.size());
  for (const auto& [name, choice] : choices) names.push_back(name);
  verb.add_option_function<std::string>(
          option, [&chosen, &choices](const std::string& name) { chosen = choices.at(name); }, help)
      ->check(CLI::IsMember(names));
}

void add_optimize(CLI::App& parent, Session& session) {
  const auto [verb, options] = add_verb(
      parent, session, "optimize", "Move the vertices to where they agree best with the edges", optimize);
  verb->add_option("GRAPH", options->files, "g2o or TORO text; several files are read as one")->required();
  add_unpack_limit(*verb, options->unpack_limit);
  add_output(*verb, "--out", options->out, "g2o file to write");
  add_output(*verb, "--svg", options->picture, "picture to write: trajectory before and after, loops");
  add_choice(*verb, "--start", options->solver.start, graph_starts(), "first guess to try first");
  add_choice(*verb, "--method", options->solver.method, graph_methods(), "how steps are taken");
  verb->add_option("--iterations", options->solver.max_iterations, "at most so many from one first guess")
      ->check(whole(1, 100000))
      ->capture_default_str();
}

void add_info(CLI::App& parent, Session& session) {
  const auto [verb, options] = add_verb(
      parent, session, "info", "What a pose graph holds, and how well it fits its edges", describe_graph);
  verb->add_option("GRAPH", options->files, "g2o or TORO text; several files are read as one")->required();
  add_unpack_limit(*verb, options->unpack_limit);
}

void add_build(CLI::App& parent, Session& session) {
  const auto [verb, options] = add_verb(
      parent, session, "build", "Make a graph and a map of the scans and ticks of a recording", build);
  verb->add_option("RECORDING", options->recording, "in any form that solve reads")->required();
  add_output(*verb, "--out", options->out, "g2o file to write: poses of the lidar at keyframes");
  add_output(*verb, "--svg", options->picture, "picture to write: map, trajectory before and after, loops");
  add_reading_options(*verb, options->reading);
  verb->add_option("--distance", options->graph.spacing.distance, "m of travel from keyframe to keyframe")
      ->check(finite(0.01, 100.0))
      ->capture_default_str();
  verb->add_option("--rotation", options->graph.spacing.rotation, "rad turned from keyframe to keyframe")
      ->check(finite(0.01, 6.0))
      ->capture_default_str();
}

}  // namespace

void add_graph(CLI::App& app, Session& session) {
  auto* verb = app.add_subcommand("graph", "Pose graphs: made of recordings, optimised, inspected");
  verb->require_subcommand(1);
  verb->fallthrough();
  add_optimize(*verb, session);
  add_info(*verb, session);
  add_build(*verb, session);
}

}  // namespace odomcalib::cli
