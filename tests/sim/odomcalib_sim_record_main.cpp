// odomcalib-sim-record: one simulated recording with known truth, for demonstrations and scripts.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>

#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"
#include "tests/sim/effects/blind_case.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/ros/containers.hpp"
#include "tests/sim/world/rooms.hpp"

namespace {

using namespace odomcalib::sim;

struct Arguments {
  std::uint64_t seed = 1;
  std::string out, truth, path, effect, room = "furnished", drive = "guided";
  double size = -1.0, duration = 0.0;
  int beams = LidarOptions{}.beams_per_turn;
};

std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  for (const EffectKind& kind : effect_kinds()) names.push_back(kind.name);
  return names;
}

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--seed", arguments.seed, "robot, noise and random room are drawn from this number");
  app.add_option("--out", arguments.out,
                 "recording to write: .jsonl, .jsonl.gz, .bag (ROS 1), .mcap or .db3 (ROS 2)")
      ->required();
  app.add_option("--truth", arguments.truth, "file for the true parameters (JSON)");
  app.add_option("--path", arguments.path, "file for the true poses of the base (TUM)");
  app.add_option("--effect", arguments.effect, "something that the plain model lacks")
      ->check(CLI::IsMember(effect_names()));
  app.add_option("--size", arguments.size, "of the effect, in its unit; default: its largest usual size");
  app.add_option("--room", arguments.room, "")
      ->check(CLI::IsMember({"furnished", "workshop", "corridor", "random"}));
  app.add_option("--drive", arguments.drive, "")->check(CLI::IsMember({"guided", "lazy", "random", "rest"}));
  app.add_option("--duration", arguments.duration, "s; default: as long as the drive takes, random: 240");
  app.add_option("--beams", arguments.beams, "readings of the lidar in a turn")
      ->check(CLI::Range(8, 10000))
      ->capture_default_str();
}

Room choose_room(const Arguments& arguments) {
  if (arguments.room == "workshop") return workshop();
  if (arguments.room == "corridor") return corridor();
  if (arguments.room == "random") return random_room(arguments.seed);
  return furnished_room();
}

Drive choose_drive(const Arguments& arguments, SimulationConfig& config) {
  const auto pattern = arguments.drive == "lazy" ? lazy_pattern() : guided_pattern();
  const bool timed = arguments.drive == "guided" || arguments.drive == "lazy";
  config.duration = arguments.duration > 0.0 ? arguments.duration : timed ? total_duration(pattern) : 240.0;
  if (arguments.drive == "random") return random_drive(config.nominal, arguments.seed);
  if (arguments.drive == "rest") return follow(config.nominal, {});
  return follow(config.nominal, pattern);
}

BlindAnswer add_effect(const Arguments& arguments, SimulationConfig& config) {
  BlindAnswer answer;
  const EffectKind* kind = find_effect(arguments.effect);
  if (kind == nullptr) return answer;
  Random random(arguments.seed);
  const double size = arguments.size >= 0.0 ? arguments.size : kind->largest;
  answer.effects = {{kind->name, kind->catalogue_name, kind->depends_on, size, kind->unit}};
  config.disturbances = {kind->make(size, random)};
  return answer;
}

odomcalib::Result<void> write_recording(const odomcalib::Recording& recording,
                                        const std::filesystem::path& path) {
  const std::string form = path.extension();
  if (form == ".bag") {
    const RosLog log = ros_log(recording, {.wire = Wire::ros1});
    return odomcalib::replace_file(path, write_bag(log, {.packing = RosPacking::lz4}));
  }
  const RosLog log = ros_log(recording, {.wire = Wire::cdr_little});
  if (form == ".mcap") return odomcalib::replace_file(path, write_mcap(log, {.packing = RosPacking::zstd}));
  if (form != ".db3") return odomcalib::write_recording_jsonl(recording, path);
  write_rosbag2(log, path);
  return {};
}

void write_path(const SimulatedRun& run, const std::string& file) {
  std::ofstream out(file);
  out << std::fixed << std::setprecision(9);
  for (const TruthSample& sample : run.path)
    out << sample.t << ' ' << sample.pose.x << ' ' << sample.pose.y << " 0 0 0 "
        << std::sin(0.5 * sample.pose.yaw) << ' ' << std::cos(0.5 * sample.pose.yaw) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Simulates a differential-drive robot with a lidar in a room and writes the recording"};
  Arguments arguments;
  declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  SimulationConfig config = standard_config(arguments.seed);
  config.room = choose_room(arguments);
  config.lidar.beams_per_turn = arguments.beams;
  const Drive drive = choose_drive(arguments, config);
  BlindAnswer answer = add_effect(arguments, config);
  const SimulatedRun run = simulate_recording(config, drive);
  answer.truth = config.truth;
  answer.drive = arguments.drive;
  answer.least_clearance = run.least_clearance;
  if (const auto written = write_recording(run.recording, arguments.out); !written) {
    std::fprintf(stderr, "odomcalib-sim-record: %s\n", written.error().text().c_str());
    return 1;
  }
  if (!arguments.truth.empty()) std::ofstream(arguments.truth) << answers_json({answer});
  if (!arguments.path.empty()) write_path(run, arguments.path);
  if (run.least_clearance < 0.2)
    std::fprintf(stderr, "odomcalib-sim-record: the robot came within %.2f m of a wall\n",
                 run.least_clearance);
  return 0;
}
