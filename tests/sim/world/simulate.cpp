#include "tests/sim/world/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim {

namespace {

/// Pose that a host believes by integrating nominal parameters, for closed-loop drives.
class BelievedPose {
 public:
  explicit BelievedPose(const Geometry& nominal) : nominal_(nominal) {}

  const Pose& update(const std::array<std::int64_t, 2>& counts) {
    const double turn = 2.0 * std::numbers::pi / nominal_.ticks_per_rev;
    const double left =
        0.5 * nominal_.left_diameter * turn * static_cast<double>(counts[kLeft] - last_[kLeft]);
    const double right =
        0.5 * nominal_.right_diameter * turn * static_cast<double>(counts[kRight] - last_[kRight]);
    const double half_turn = 0.5 * (right - left) / nominal_.track_width;
    pose_.yaw += half_turn;
    pose_ = compose(pose_, {0.5 * (left + right), 0.0, half_turn});
    last_ = counts;
    return pose_;
  }

 private:
  Geometry nominal_;
  std::array<std::int64_t, 2> last_{};
  Pose pose_;
};

/// Sample of the recording, and when it really was.
template <typename Sample>
struct Timed {
  Sample sample;
  double t = 0.0;  // s, true
};

/// Gathers beams into sweeps as a driver would: from angle 0 to angle 0.
class SweepBuilder {
 public:
  SweepBuilder(const LidarHead& head, const Disturbances& disturbances, std::vector<Timed<Scan>>& out)
      : head_(head), disturbances_(disturbances), out_(out) {}

  void add(const Beam& beam) {
    if (beam.index == 0) begin(beam);
    if (scan_.ranges.size() != static_cast<std::size_t>(beam.index)) return;  // joined in mid-turn
    scan_.ranges.push_back(static_cast<float>(beam.range));
    scan_.intensities.push_back(static_cast<float>(std::round(beam.intensity)));
    if (beam.index + 1 == head_.options().beams_per_turn) finish();
  }

 private:
  void begin(const Beam& beam) {
    const LidarOptions& options = head_.options();
    scan_ = Scan{};
    scan_.t = beam.t;
    scan_.angle_increment = -2.0 * std::numbers::pi / options.beams_per_turn;
    scan_.time_increment = head_.beam_interval();
    scan_.range_min = options.range_min;
    scan_.range_max = options.range_max;
  }

  void finish() {
    ScanStamp stamp{scan_.t, 1.0 / head_.options().turns_per_second, scan_.t};
    for (const auto& effect : disturbances_) effect->on_scan(stamp);
    scan_.t = stamp.stamp;
    out_.push_back({std::move(scan_), stamp.t});
    scan_ = Scan{};
  }

  const LidarHead& head_;
  const Disturbances& disturbances_;
  std::vector<Timed<Scan>>& out_;
  Scan scan_;
};

RobotDescription description(const SimulationConfig& config) {
  RobotDescription robot;
  robot.left_wheel_diameter = config.nominal.left_diameter;
  robot.right_wheel_diameter = config.nominal.right_diameter;
  robot.track_width = config.nominal.track_width;
  robot.ticks_per_rev = config.nominal.ticks_per_rev;
  const Pose& lidar = config.nominal.lidar;
  if (config.name_lidar_pose) robot.lidar_pose = {lidar.x, lidar.y, lidar.yaw};
  robot.robot_id = "simulated-" + std::to_string(config.seed);
  return robot;
}

void sample_ticks(const SimulationConfig& config, const Body& body, std::vector<Timed<TickSample>>& out) {
  TickReading reading{body.time(), body.time(), body.counts(), false};
  for (const auto& effect : config.disturbances) effect->on_ticks(reading);
  if (!reading.lost)
    out.push_back({{reading.stamp, reading.counts[kLeft], reading.counts[kRight], 0}, reading.t});
}

/// Into the recording in the order of their stamps.
template <typename Sample>
void store_by_stamp(std::vector<Timed<Sample>> timed, std::vector<Sample>& samples,
                    std::vector<double>& times) {
  std::stable_sort(timed.begin(), timed.end(),
                   [](const Timed<Sample>& a, const Timed<Sample>& b) { return a.sample.t < b.sample.t; });
  for (Timed<Sample>& one : timed) {
    samples.push_back(std::move(one.sample));
    times.push_back(one.t);
  }
}

}  // namespace

SimulatedRun simulate_recording(const SimulationConfig& config, const Drive& drive) {
  SimulatedRun run;
  run.truth = config.truth;
  run.recording.name = "simulated-" + std::to_string(config.seed) + ".jsonl";
  run.recording.robot = description(config);
  run.least_clearance = std::numeric_limits<double>::infinity();

  Body body(config.truth, config.body, config.seed, config.disturbances);
  LidarHead head(config.room, config.truth.lidar, config.lidar, config.seed, config.disturbances);
  std::vector<Timed<TickSample>> ticks;
  std::vector<Timed<Scan>> scans;
  SweepBuilder sweeps(head, config.disturbances, scans);
  BelievedPose believed(config.nominal);
  std::vector<Beam> beams;
  const auto every = [&](double period) {
    return std::max<std::int64_t>(1, std::llround(period / config.body.step));
  };
  const std::int64_t steps = std::llround(config.duration / config.body.step);
  const std::int64_t tick_steps = every(config.tick_period), truth_steps = every(config.truth_period);
  for (std::int64_t step = 0; step <= steps; ++step) {
    if (step % truth_steps == 0) {
      run.path.push_back({body.time(), body.pose(), body.rate()});
      run.least_clearance =
          std::min(run.least_clearance, config.room.clearance({body.pose().x, body.pose().y}));
    }
    if (step % tick_steps == 0) {
      sample_ticks(config, body, ticks);
      const WheelCommand wanted = drive(body.time(), believed.update(body.counts()));
      body.command(wanted.left, wanted.right);
    }
    const Pose before = body.pose();
    const double from = body.time();
    body.advance();
    beams.clear();
    head.advance(from, before, body.time(), body.pose(), beams);
    for (const Beam& beam : beams) sweeps.add(beam);
  }
  store_by_stamp(std::move(ticks), run.recording.ticks, run.tick_times);
  store_by_stamp(std::move(scans), run.recording.scans, run.scan_times);
  return run;
}

SimulationConfig standard_config(std::uint64_t seed) {
  SimulationConfig config;
  config.truth = draw_truth(config.nominal, seed);
  config.room = furnished_room();
  config.seed = seed;
  config.duration = total_duration(guided_pattern());
  config.body.motor.acceleration = config.body.motor.deceleration = 0.6 / 0.075;  // 0.6 m/s^2 at the rim
  config.body.slip_noise = 0.0004;
  return config;
}

SimulatedRun standard_run(std::uint64_t seed) {
  const SimulationConfig config = standard_config(seed);
  return simulate_recording(config, follow(config.nominal, guided_pattern()));
}

}  // namespace odomcalib::sim
