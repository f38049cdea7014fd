#include "proto/recording/recording_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>

#include "proto/number_text.hpp"
#include "proto/recording/clock_set_back.hpp"
#include "proto/recording/scan_checks.hpp"
#include "proto/recording/scan_parts.hpp"
#include "proto/recording/second_writer.hpp"
#include "proto/recording/stamp_units.hpp"
#include "proto/recording/tick_counts.hpp"
#include "proto/recording/wheel_motion.hpp"

namespace odomcalib {
namespace {

constexpr double kReorderWindow = 1.0;  // s, DESIGN 4.2: out of order by up to a second
constexpr double kLeap = 60.0;          // s, a longer step ahead is believed when the next sample confirms it
constexpr double kLatestTime =
    9e9;  // s; as nanoseconds it still fits 64 bits, and is later than any clock shows
// Samples of a stream that tells that time went on. Chosen: a second or two of most devices.
constexpr std::size_t kFewestOfWitness = 20;
// Span of a stream whose clock was put forward over that of the witness: longer ones are recordings of which
// only one has the witness, one after the other. Chosen: recorders start and end apart.
constexpr double kLongerThanWitness = 1.5;
constexpr std::int64_t kLargestCount = std::int64_t{1} << 53;
constexpr double kNone = -std::numeric_limits<double>::infinity();

// rad; as a count of 2^20 a turn it still is an exact double.
constexpr double kLargestAngle = 1e9;
// rad/s; a wheel of 1 cm at 10 m/s turns at 2000 rad/s.
constexpr double kLargestWheelSpeed = 1e4;

// m; UTM coordinates stay below.
constexpr double kFarthestPosition = 1e7;

constexpr const char* kNoAngles = "left or right missing or not an angle";
constexpr const char* kNoSpeeds = "left or right missing or not the speed of a wheel";

bool is_angle(double value) { return std::abs(value) <= kLargestAngle; }
bool is_wheel_speed(double value) { return std::abs(value) <= kLargestWheelSpeed; }
bool is_position(double value) { return std::abs(value) <= kFarthestPosition; }

bool sane_time(double t) { return std::isfinite(t) && std::abs(t) <= kLatestTime; }

std::string stamp_problem(double t) {
  const char* unit = unit_of_date(t);
  return unit == nullptr ? "time stamp missing or impossible" : stamp_reason(unit);
}

template <typename Sample>
void sort_by_time(std::vector<Sample>& samples) {
  const auto earlier = [](const Sample& a, const Sample& b) { return a.t < b.t; };
  if (!std::is_sorted(samples.begin(), samples.end(), earlier))
    std::stable_sort(samples.begin(), samples.end(), earlier);
}

template <typename Turned>
bool says_the_same(const Turned& a, const Turned& b) {
  return a.left == b.left && a.right == b.right;
}
bool says_the_same(const PoseSample& a, const PoseSample& b) {
  return a.x == b.x && a.y == b.y && a.yaw == b.yaw;
}
bool says_the_same(const GyroSample& a, const GyroSample& b) { return a.yaw_rate == b.yaw_rate; }
bool says_the_same(const Scan& a, const Scan& b) { return a.ranges == b.ranges; }

/// A stream whose clock was not set.
struct Witness {
  std::string many;   ///< what it is called
  double span = 0.0;  ///< s
};

std::string number_text(double value) {
  std::string text = std::to_string(value);
  return text;
}

Error missing_unit(const std::string& field, double value, const char* unit, double limit,
                   const std::string& where) {
  const std::string remedy = "state it in " + std::string(unit) +
                             " in the robot line or with --robot FILE; odomcalib-robot.toml(5) shows one";
  if (value == 0.0)
    return {ErrorCode::missing_units, "robot description lacks \"" + field + "\", or has 0 for it", where,
            remedy};
  if (std::isnan(value))
    return {ErrorCode::missing_units, "robot description has a \"" + field + "\" that is no number", where,
            remedy};
  const std::string bound = value > 0.0 ? "at most " + number_text(limit) : "greater than 0";
  return {
      ErrorCode::missing_units,
      "robot description has \"" + field + "\" = " + number_text(value) + ", must be " + bound + " " + unit,
      where, remedy};
}

/// Empty where no counter wraps at a number of its own.
std::string text_of_wraps(const std::array<CounterModulus, 2>& moduli) {
  const auto& [left, right] = moduli;
  std::string text;
  if (left.modulus != 0 && left.modulus == right.modulus)
    text = "both counters wrap at " + std::to_string(left.modulus);
  else if (left.modulus != 0 && right.modulus != 0)
    text = "the left counter wraps at " + std::to_string(left.modulus) + ", the right one at " +
           std::to_string(right.modulus);
  else if (left.modulus != 0 || right.modulus != 0)
    text = std::string("the ") + (left.modulus != 0 ? "left" : "right") + " counter wraps at " +
           std::to_string(std::max(left.modulus, right.modulus));
  if (left.is_fast || right.is_fast)
    text += "; steps of half of that and more were told by the step before each";
  return text;
}

/// Empty where no jump looks like a wrap at a number that the samples do not tell.
std::string text_of_suspected(const std::array<CounterModulus, 2>& moduli) {
  std::string text;
  for (std::size_t side = 0; side < 2; ++side)
    if (moduli.at(side).suspected != 0)
      text += std::string(text.empty() ? "the " : ", the ") + (side == 0 ? "left" : "right") +
              " counter seems to wrap at about " + std::to_string(moduli.at(side).suspected);
  return text.empty() ? text
                      : text +
                            "; so far apart the samples do not tell where it went on: record the counts more "
                            "often, or counts that do not start again";
}

Values values_of(const TickSample& sample) {
  return {static_cast<double>(sample.left), static_cast<double>(sample.right), 0.0};
}
Values values_of(const WheelSample& sample) { return {sample.left, sample.right, 0.0}; }
Values values_of(const PoseSample& sample) { return {sample.x, sample.y, sample.yaw}; }

}  // namespace

RecordingBuilder::StreamClock::StreamClock() : newest(kNone) {}

std::optional<Error> check_robot(const RobotDescription& robot, const std::string& where) {
  struct Field {
    const char* name;
    double value;
    const char* unit;
    double limit;  // beyond it, the number is in another unit (mm instead of m)
  };
  // Both sides come from one member of the file, mostly: name that one.
  const bool one_diameter = robot.left_wheel_diameter == robot.right_wheel_diameter ||
                            (std::isnan(robot.left_wheel_diameter) && std::isnan(robot.right_wheel_diameter));
  const std::array<Field, 4> fields{{
      {one_diameter ? "wheel_diameter" : "left_wheel_diameter", robot.left_wheel_diameter, "m", 10.0},
      {one_diameter ? "wheel_diameter" : "right_wheel_diameter", robot.right_wheel_diameter, "m", 10.0},
      {"track_width", robot.track_width, "m", 50.0},
      {"ticks_per_rev", robot.ticks_per_rev, "counts per wheel turn", 1e9},
  }};
  for (const auto& field : fields)
    if (!(field.value > 0.0 && field.value <= field.limit))
      return missing_unit(field.name, field.value, field.unit, field.limit, where);
  return std::nullopt;
}

void RecordingBuilder::discard(const std::string& what, const std::string& reason, std::size_t count,
                               std::optional<double> t) {
  if (count == 0) return;
  Discarded& one = discarded_.try_emplace({what, reason}, Discarded{what, reason}).first->second;
  one.count += count;
  if (t) include(one, *t);
}

/// One wild stamp far ahead must not make everything behind it late: it goes, when the next sample continues
/// before it.
template <typename Sample>
void RecordingBuilder::forget_leap(const char* what, StreamClock& clock, std::vector<Sample>& stream) {
  const auto leap = std::find_if(stream.rbegin(), stream.rend(),
                                 [&](const Sample& sample) { return sample.t == clock.newest; });
  if (leap != stream.rend()) stream.erase(std::next(leap).base());
  discard(what, "time stamp far ahead of its neighbours");
  clock.newest = *clock.before_leap;
}

bool RecordingBuilder::is_stamped(const char* what, double t) {
  if (sane_time(t)) return true;
  discard(what, stamp_problem(t));
  return false;
}

template <typename Sample>
bool RecordingBuilder::in_time(const char* what, const Sample& sample, StreamClock& clock,
                               std::vector<Sample>& stream) {
  const bool late = sample.t < clock.newest - kReorderWindow;
  if (late && clock.before_leap && sample.t >= *clock.before_leap - kReorderWindow)
    forget_leap(what, clock, stream);
  else if (late) {
    discard(what, "out of order by more than 1 s", 1, sample.t);
    return false;
  }
  clock.before_leap.reset();
  if (clock.newest != kNone && sample.t > clock.newest + kLeap) clock.before_leap = clock.newest;
  clock.newest = std::max(clock.newest, sample.t);
  return true;
}

template <typename Sample>
void RecordingBuilder::drop_late(const char* what, std::vector<Sample>& stream) {
  StreamClock clock;
  std::vector<Sample> kept;
  kept.reserve(stream.size());
  for (const Sample& sample : stream)
    if (in_time(what, sample, clock, kept)) kept.push_back(sample);
  stream = std::move(kept);
}

/// Each sensor has a clock of its own.
void RecordingBuilder::drop_late_scans() {
  std::map<std::string, StreamClock> clocks;
  std::vector<Scan> kept;
  kept.reserve(recording_.scans.size());
  for (Scan& scan : recording_.scans) {
    if (!in_time("scan", scan, clocks[scan.sensor], kept)) continue;
    const auto problems = clean_scan(scan);
    readings_ += scan.ranges.size();
    discard("beam", "not a number", problems.not_a_number);
    discard("beam", reason_outside_limits(problems.unit), problems.out_of_limits);
    kept.push_back(std::move(scan));
  }
  recording_.scans = std::move(kept);
}

/// Streams of one device have one clock.
enum class RecordingBuilder::Device { wheels, scan, pose, gyro };

template <typename Visit>
void RecordingBuilder::each_stream(Visit visit) {
  visit(Device::wheels, "counts", recording_.ticks);
  visit(Device::wheels, "wheel angles", recording_.wheels);
  visit(Device::wheels, "wheel speeds", recording_.wheel_speeds);
  for (auto* halves : {&wheel_halves_, &speed_halves_})
    for (auto& side : halves->samples) visit(Device::wheels, "wheels", side);
  visit(Device::wheels, "odometry", recording_.odometry);
  visit(Device::scan, "scans", recording_.scans);
  visit(Device::pose, "poses", recording_.poses);
  visit(Device::gyro, "gyro", recording_.gyro);
}

/// One device's clock that is set back, while another device tells that time went on. Where the streams of
/// both go back, files were joined in the wrong order, and of a gyro nothing is known but that it goes with
/// one of them.
void RecordingBuilder::put_clocks_forward() {
  if (!is_in_order_) return;
  std::set<Device> set_back_devices;
  std::map<Device, Witness> steady;
  each_stream([&](Device device, const char* many, const auto& samples) {
    if (device == Device::gyro || samples.size() < kFewestOfWitness) return;
    const std::vector<double> stamps = stamps_of(samples);
    const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
    if (!set_back(stamps).empty())
      set_back_devices.insert(device);
    else
      steady.try_emplace(device, Witness{many, *last - *first});
  });
  if (set_back_devices.size() != 1) return;
  const Device device = *set_back_devices.begin();
  const auto witness =
      std::find_if(steady.begin(), steady.end(), [&](const auto& one) { return one.first != device; });
  if (witness == steady.end()) return;
  bool told = false;
  each_stream([&](Device of, const char* many, auto& samples) {
    if (of != device && of != Device::gyro) return;
    const std::vector<double> given = stamps_of(samples);
    const std::vector<SetBack> steps = set_back(given);
    const std::vector<double> stamps = without_steps(given, steps);
    if (steps.empty() || !std::all_of(stamps.begin(), stamps.end(), sane_time) ||
        stamps.back() - stamps.front() > kLongerThanWitness * witness->second.span)
      return;
    set_stamps(samples, stamps);
    for (const SetBack& step : steps)
      if (!told && of == device)
        recording_.repairs.push_back(repaired_clock(many, -step.by, printed("%.12g", stamps[step.first]),
                                                    witness->second.many, "their clock was set back"));
    told = told || of == device;
  });
}

/// Once all samples are there: whether one comes late, or its clock was set back, those after it tell.
void RecordingBuilder::drop_late_samples() {
  put_clocks_forward();
  drop_late("ticks", recording_.ticks);
  drop_late("wheels", recording_.wheels);
  drop_late("wheel_speeds", recording_.wheel_speeds);
  for (auto& side : wheel_halves_.samples) drop_late("wheels", side);
  for (auto& side : speed_halves_.samples) drop_late("wheel_speeds", side);
  drop_late("odometry", recording_.odometry);
  drop_late("pose", recording_.poses);
  drop_late("gyro", recording_.gyro);
  drop_late_scans();
}

void RecordingBuilder::add_robot(RobotDescription robot) {
  const auto& old = recording_.robot;
  if (!have_robot_) {
    recording_.robot = std::move(robot);
    have_robot_ = true;
  } else if (robot.left_wheel_diameter != old.left_wheel_diameter || robot.track_width != old.track_width ||
             robot.right_wheel_diameter != old.right_wheel_diameter || robot.lidar_pose != old.lidar_pose ||
             robot.ticks_per_rev != old.ticks_per_rev || robot.robot_id != old.robot_id ||
             robot.controller != old.controller || robot.controller_id != old.controller_id) {
    discard("robot", "differs from the first robot description");
  }
}

void RecordingBuilder::add_ticks(TickSample sample) {
  if (std::abs(sample.left) > kLargestCount || std::abs(sample.right) > kLargestCount)
    discard("ticks", "count beyond 2^53");
  else if (is_stamped("ticks", sample.t))
    recording_.ticks.push_back(sample);
}

void RecordingBuilder::add_wheels(WheelSample sample) {
  if (!is_angle(sample.left) || !is_angle(sample.right))
    discard("wheels", kNoAngles);
  else if (is_stamped("wheels", sample.t))
    recording_.wheels.push_back(sample);
}

void RecordingBuilder::add_wheel_speeds(WheelSample sample) {
  if (!is_wheel_speed(sample.left) || !is_wheel_speed(sample.right))
    discard("wheel_speeds", kNoSpeeds);
  else if (is_stamped("wheel_speeds", sample.t))
    recording_.wheel_speeds.push_back(sample);
}

void RecordingBuilder::add_half(const char* what, Halves& halves, Side side, SideSample sample) {
  const auto at = static_cast<std::size_t>(side);
  if (is_stamped(what, sample.t)) halves.samples.at(at).push_back(sample);
}

void RecordingBuilder::add_wheel(Side side, SideSample sample) {
  if (!is_angle(sample.value)) return discard("wheels", kNoAngles);
  add_half("wheels", wheel_halves_, side, sample);
}

void RecordingBuilder::add_wheel_speed(Side side, SideSample sample) {
  if (!is_wheel_speed(sample.value)) return discard("wheel_speeds", kNoSpeeds);
  add_half("wheel_speeds", speed_halves_, side, sample);
}

void RecordingBuilder::add_odometry(PoseSample sample) {
  if (!is_position(sample.x) || !is_position(sample.y) || !is_angle(sample.yaw))
    discard("odometry", "x, y or yaw missing or impossible");
  else if (is_stamped("odometry", sample.t))
    recording_.odometry.push_back(sample);
}

void RecordingBuilder::add_scan(Scan scan) {
  list_first_sent_first(scan);
  if (!is_stamped("scan", scan.t)) return;
  if (const char* problem = scan_problem(scan)) return discard("scan", problem);
  // Nothing is measured with them.
  if (!scan.intensities.empty() && scan.intensities.size() != scan.ranges.size()) {
    discard("value", "intensities do not match ranges");
    scan.intensities.clear();
  }
  if (intensities_ == Intensities::left_out)
    std::vector<float>().swap(scan.intensities);  // clear() would keep them
  recording_.scans.push_back(std::move(scan));
}

void RecordingBuilder::add_pose(PoseSample sample) {
  if (!std::isfinite(sample.x) || !std::isfinite(sample.y) || !std::isfinite(sample.yaw))
    discard("pose", "x, y or yaw missing or not a number");
  else if (is_stamped("pose", sample.t))
    recording_.poses.push_back(sample);
}

void RecordingBuilder::add_gyro(GyroSample sample) {
  if (!std::isfinite(sample.yaw_rate))
    discard("gyro", "yaw_rate missing or not a number");
  else if (is_stamped("gyro", sample.t))
    recording_.gyro.push_back(sample);
}

void RecordingBuilder::add_increment(IncrementSample sample) {
  const bool finite = std::isfinite(sample.left_speed) && std::isfinite(sample.right_speed) &&
                      std::all_of(sample.lidar_motion.begin(), sample.lidar_motion.end(),
                                  [](double v) { return std::isfinite(v); });
  if (!finite || !std::isfinite(sample.duration) || sample.duration <= 0.0)
    discard("tuple", "a value is missing or impossible");
  else
    recording_.increments.push_back(sample);
}

bool RecordingBuilder::has_motion() const {
  return !recording_.ticks.empty() || !recording_.wheels.empty() || !recording_.wheel_speeds.empty() ||
         !recording_.odometry.empty() || wheel_halves_.any() || speed_halves_.any();
}

Error RecordingBuilder::no_motion(const std::string& where) const {
  std::string what = "no message holds the motion of the wheels";
  std::size_t most = 0;
  for (const auto& [key, one] : discarded_) {
    const bool of_wheels = one.what == "wheels" || one.what == "wheel_speeds" || one.what == "odometry";
    if (!of_wheels || one.count <= most) continue;
    most = one.count;
    what = "no message holds the motion of the wheels: " + std::to_string(one.count) + " x " + one.what +
           " left out, " + one.reason;
  }
  return {ErrorCode::empty, what, where,
          "choose another topic: --topic wheels=TOPIC or --topic odometry=TOPIC"};
}

Error RecordingBuilder::with_remarks(Error error) const {
  error.remarks = recording_.choices;
  return error;
}

/// Both wheels at one instant, of wheels that came one by one. Among samples that have both, one wheel alone
/// is a sample that is broken.
void RecordingBuilder::join_halves(MotionSource source, Halves& halves, std::vector<WheelSample>& stream) {
  if (!halves.any()) return;
  const bool angles = source == MotionSource::wheels;
  const char* reason = angles ? kNoAngles : kNoSpeeds;
  auto& [left, right] = halves.samples;
  if (!stream.empty() || left.empty() || right.empty()) {
    if (stream.empty())
      one_wheel_ = std::to_string(left.size() + right.size()) + " " + name_of(source) + " lines have the " +
                   (right.empty() ? "left wheel, and none has the right one"
                                  : "right wheel, and none has the left one");
    discard(name_of(source), reason, left.size() + right.size());
    left.clear();
    right.clear();
    return;
  }
  for (auto* side : {&left, &right}) {
    sort_by_time(*side);
    const auto same = [](const auto& a, const auto& b) { return a.t == b.t; };
    const auto end = std::unique(side->begin(), side->end(), same);
    discard(name_of(source), kRepeatedStamp, static_cast<std::size_t>(side->end() - end));
    side->erase(end, side->end());
  }
  const std::string counts =
      std::to_string(left.size()) + " left, " + std::to_string(right.size()) + " right";
  const JoinedWheels joined = joined_wheels(std::exchange(left, {}), std::exchange(right, {}),
                                            angles ? Between::linear : Between::held);
  const Side moved = joined.kept == Side::left ? Side::right : Side::left;
  discard(name_of(source), "the other wheel has no value near that time", joined.alone);
  stream = joined.wheels;
  choose(std::string(name_of(source)) + ": each sample has one wheel only (" + counts + "); the " +
         name_of(moved) + " wheel was brought to the times of the " + name_of(joined.kept) +
         (angles ? ", between its neighbours" : ", each speed held until the next"));
}

bool RecordingBuilder::has_data() const {
  return has_motion() || !recording_.scans.empty() || !recording_.poses.empty() || !recording_.gyro.empty() ||
         !recording_.increments.empty();
}

Error RecordingBuilder::nothing_usable(const std::string& where) const {
  for (const auto& [key, one] : discarded_)
    if (const std::string unit = unit_of_reason(one.reason); !unit.empty())
      return wrong_dates(one.what, one.count, unit, where);
  const auto most = std::max_element(discarded_.begin(), discarded_.end(), [](const auto& a, const auto& b) {
    return a.second.count < b.second.count;
  });
  const std::string what = "no usable wheel motion, scans, poses or increments";
  if (most == discarded_.end())
    return {ErrorCode::empty, what, where, "check that the recording was running while the robot moved"};
  const Discarded& one = most->second;
  return {ErrorCode::empty,
          what + ": " + std::to_string(one.count) + " x " + one.what + " left out, " + one.reason, where,
          "compare a line of it with docs/user/formats.md"};
}

void RecordingBuilder::merge_robot(const RobotDescription* fallback) {
  if (fallback == nullptr) return;
  auto& robot = recording_.robot;
  const auto take = [](double& value, double other) {
    if (value == 0.0) value = other;
  };
  take(robot.left_wheel_diameter, fallback->left_wheel_diameter);
  take(robot.right_wheel_diameter, fallback->right_wheel_diameter);
  take(robot.track_width, fallback->track_width);
  take(robot.ticks_per_rev, fallback->ticks_per_rev);
  if (!robot.lidar_pose) robot.lidar_pose = fallback->lidar_pose;
  if (robot.robot_id.empty()) robot.robot_id = fallback->robot_id;
  if (robot.controller.empty()) robot.controller = fallback->controller;
  if (robot.controller_id.empty()) robot.controller_id = fallback->controller_id;
}

void RecordingBuilder::count_streams() {
  std::map<std::string, std::size_t> all = {{"ticks", recording_.ticks.size()},
                                            {"wheels", recording_.wheels.size()},
                                            {"wheel_speeds", recording_.wheel_speeds.size()},
                                            {"odometry", recording_.odometry.size()},
                                            {"scan", recording_.scans.size()},
                                            {"pose", recording_.poses.size()},
                                            {"gyro", recording_.gyro.size()},
                                            {"tuple", recording_.increments.size()}};
  for (const auto& [key, one] : discarded_)
    if (const auto kept = all.find(one.what); kept != all.end()) kept->second += one.count;
  all["beam"] = readings_;  // those left out are among them
  streams_ = std::move(all);
}

/// Keeps the first of several samples with one stamp.
template <typename Sample, typename Same>
void RecordingBuilder::drop_repeated(const char* what, std::vector<Sample>& samples, Same same) {
  if (samples.empty()) return;
  auto kept = samples.begin();
  for (auto next = std::next(kept); next != samples.end(); ++next) {
    if (same(*kept, *next)) {
      discard(what, kRepeatedStamp, 1, next->t);
      if (says_the_same(*kept, *next)) ++discarded_[{what, kRepeatedStamp}].copies;
    } else if (++kept != next) {
      *kept = std::move(*next);
    }
  }
  samples.erase(std::next(kept), samples.end());
}

void RecordingBuilder::sort_streams() {
  sort_by_time(recording_.ticks);
  sort_by_time(recording_.wheels);
  sort_by_time(recording_.wheel_speeds);
  sort_by_time(recording_.odometry);
  sort_by_time(recording_.scans);
  sort_by_time(recording_.poses);
  sort_by_time(recording_.gyro);
  const auto same = [](const auto& a, const auto& b) { return a.t == b.t; };
  const auto same_scan = [](const Scan& a, const Scan& b) { return a.t == b.t && a.sensor == b.sensor; };
  if (const std::size_t joined = join_parts_of_one_stamp(recording_.scans); joined > 0)
    choose("scan: " + std::to_string(joined) +
           " messages carry the stamp of the one before and go on where it ended; joined, " +
           std::to_string(recording_.scans.size()) + " scans");
  drop_repeated("ticks", recording_.ticks, same);
  drop_repeated("wheels", recording_.wheels, same);
  drop_repeated("wheel_speeds", recording_.wheel_speeds, same);
  drop_repeated("odometry", recording_.odometry, same);
  drop_repeated("scan", recording_.scans, same_scan);
  drop_repeated("pose", recording_.poses, same);
  drop_repeated("gyro", recording_.gyro, same);
  // Both are kept as long as the recording; growing has left them up to twice their size.
  recording_.ticks.shrink_to_fit();
  recording_.scans.shrink_to_fit();
}

/// The finest that is there decides; what is coarser is left out, and counted.
void RecordingBuilder::decide_motion() {
  bool decided = !recording_.ticks.empty();
  const auto weigh = [&](MotionSource source, auto& samples) {
    if (samples.empty()) return;
    if (!decided) {
      recording_.motion = source;
      decided = true;
    } else {
      const std::string reason = std::string(name_of(recording_.motion)) + kFinerDecides;
      for (const auto& sample : samples) discard(name_of(source), reason, 1, sample.t);
      samples.clear();
    }
  };
  weigh(MotionSource::wheels, recording_.wheels);
  weigh(MotionSource::wheel_speeds, recording_.wheel_speeds);
  weigh(MotionSource::odometry, recording_.odometry);
  // Not counted: a resolution is no unit that has to be known.
  if (recording_.motion != MotionSource::ticks && recording_.robot.ticks_per_rev == 0.0)
    recording_.robot.ticks_per_rev = kFineCountsPerRev;
}

void RecordingBuilder::make_ticks() {
  const RobotDescription& robot = recording_.robot;
  MadeTicks made;
  if (recording_.motion == MotionSource::wheels)
    made = ticks_from_wheels(recording_.wheels, robot.ticks_per_rev);
  else if (recording_.motion == MotionSource::wheel_speeds)
    made = ticks_from_wheel_speeds(recording_.wheel_speeds);
  else
    made = ticks_from_odometry(recording_.odometry, robot);
  recording_.ticks = std::move(made.ticks);
  recording_.robot.ticks_per_rev = made.ticks_per_rev;
  choose(kMotionFrom + std::string(name_of(recording_.motion)));
}

/// Says between which stamps the way is not known, and which counts were not believed.
void RecordingBuilder::count_on() {
  std::vector<TickSample>& ticks = recording_.ticks;
  const std::vector<TickSample> given = ticks;
  const ContinuedCounts counts = continue_counts(ticks, recording_.robot);
  discard("ticks", kMisread, counts.misread);
  discard("ticks", kUncontinued, counts.jumps);
  for (std::size_t i = 1; i < ticks.size() && counts.jumps > 0; ++i) {
    if (ticks[i].segment == ticks[i - 1].segment || given[i].segment != given[i - 1].segment) continue;
    for (const double t : {ticks[i - 1].t, ticks[i].t}) include(discarded_[{"ticks", kUncontinued}], t);
  }
  // The correction of a misread count differs from the one that its neighbours share.
  const auto added = [&](std::size_t i) {
    return std::array{ticks[i].left - given[i].left, ticks[i].right - given[i].right};
  };
  for (std::size_t i = 1; i + 1 < ticks.size() && counts.misread > 0; ++i)
    if (added(i) != added(i - 1) && added(i - 1) == added(i + 1))
      include(discarded_[{"ticks", kMisread}], ticks[i].t);
  if (counts.jumps > 0) discarded_[{"ticks", kUncontinued}].of = ticks.size() - 1;
  if (counts.misread > 0) discarded_[{"ticks", kMisread}].of = ticks.size();
  const std::string wraps = text_of_wraps(counts.moduli), suspected = text_of_suspected(counts.moduli);
  if (!wraps.empty()) recording_.repairs.push_back({"ticks", "continued where they start again", wraps});
  if (!suspected.empty()) recording_.repairs.push_back({"ticks", "left out where they jump", suspected});
}

const char* name_of(MotionSource source) {
  switch (source) {
    case MotionSource::wheels:
      return "wheels";
    case MotionSource::wheel_speeds:
      return "wheel_speeds";
    case MotionSource::odometry:
      return "odometry";
    case MotionSource::ticks:
      break;
  }
  return "ticks";
}

template <typename Sample>
void RecordingBuilder::drop_second_writer(const char* what, std::vector<Sample>& stream) {
  std::vector<Values> values;
  values.reserve(stream.size());
  for (const Sample& sample : stream) values.push_back(values_of(sample));
  const std::vector<std::size_t> others = of_second_writer(values);
  if (others.empty()) return;
  const Values& one = values[others.front()];
  const std::string text = number_text(one[0]) + ", " + number_text(one[1]);
  recording_.repairs.push_back({what,
                                "without " + std::to_string(others.size()) + " of " +
                                    std::to_string(stream.size()) + " samples that are always " + text,
                                "a second program writes them between those that move"});
  for (const std::size_t k : others) discard(what, "always " + text + kOfSecondProgram, 1, stream[k].t);
  for (auto k = others.rbegin(); k != others.rend(); ++k)
    stream.erase(stream.begin() + static_cast<std::ptrdiff_t>(*k));
}

void RecordingBuilder::drop_second_writers() {
  drop_second_writer("ticks", recording_.ticks);
  drop_second_writer("wheels", recording_.wheels);
  drop_second_writer("wheel_speeds", recording_.wheel_speeds);
  drop_second_writer("odometry", recording_.odometry);
  drop_second_writer("pose", recording_.poses);
}

Result<Recording> RecordingBuilder::finish(const std::string& where, const RobotDescription* fallback,
                                           RobotNeed need) && {
  auto recording = finished(where, fallback, need);
  if (!recording) return with_remarks(recording.error());
  return recording;
}

Result<Recording> RecordingBuilder::finished(const std::string& where, const RobotDescription* fallback,
                                             RobotNeed need) {
  drop_late_samples();
  join_halves(MotionSource::wheels, wheel_halves_, recording_.wheels);
  join_halves(MotionSource::wheel_speeds, speed_halves_, recording_.wheel_speeds);
  if (!has_data()) return nothing_usable(where);
  merge_robot(fallback);
  count_streams();
  decide_motion();
  if (need == RobotNeed::required && !one_wheel_.empty() && !has_motion() && recording_.increments.empty())
    return Error{ErrorCode::empty, one_wheel_, where, "record both wheels: one says nothing of turns"};
  if (need == RobotNeed::required)
    if (auto problem = check_robot(recording_.robot, where)) return *problem;
  sort_streams();
  drop_second_writers();
  if (recording_.motion != MotionSource::ticks) make_ticks();
  count_on();
  for (auto& [key, one] : discarded_) {
    if (one.of == 0) one.of = streams_[one.what];
    recording_.discarded.push_back(std::move(one));
  }
  return std::move(recording_);
}

}  // namespace odomcalib
