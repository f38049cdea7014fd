// Every cell of the table of faults: a drive told in each form, with each fault and without. With the fault
// it is told, put right or listed as the table says; without, nothing is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "calib/ingest/checks.hpp"
#include "calib/solve.hpp"
#include "proto/recording/recording.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::front_door_test {
namespace {

using calib::ingest::Answer;
using calib::ingest::Form;
using ::testing::ContainsRegex;

constexpr double kPi = std::numbers::pi;
constexpr double kTurn = 2.0 * kPi;
// Relative error of a length of a recording that was put right; the drive determines them to 0.0005.
constexpr double kRight = 0.004;

const sim::SimulatedRun& drive() {
  static const sim::SimulatedRun run = [] {
    sim::SimulationConfig config = sim::standard_config(11);
    config.duration = 110.0;
    return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
  }();
  return run;
}

double way(const RobotDescription& robot, double left, double right) {
  return (right * robot.right_wheel_diameter + left * robot.left_wheel_diameter) / 4.0;
}

double turn(const RobotDescription& robot, double left, double right) {
  return (right * robot.right_wheel_diameter - left * robot.left_wheel_diameter) / 2.0 / robot.track_width;
}

/// The same motion of the wheels in another form.
void tell_wheels(Recording& r, MotionSource motion) {
  r.motion = motion;
  const double rad = kTurn / r.robot.ticks_per_rev;
  PoseSample pose;
  for (std::size_t k = 0; k + 1 < r.ticks.size(); ++k) {
    const TickSample &now = r.ticks[k], &next = r.ticks[k + 1];
    const double left = rad * static_cast<double>(next.left - now.left);
    const double right = rad * static_cast<double>(next.right - now.right);
    const double held = next.t - now.t;
    r.wheels.push_back({now.t, rad * static_cast<double>(now.left), rad * static_cast<double>(now.right)});
    r.wheel_speeds.push_back({now.t, left / held, right / held});
    pose.t = now.t;
    r.odometry.push_back(pose);
    const double yaw = pose.yaw + 0.5 * turn(r.robot, left, right);
    pose.x += way(r.robot, left, right) * std::cos(yaw);
    pose.y += way(r.robot, left, right) * std::sin(yaw);
    pose.yaw += turn(r.robot, left, right);
  }
  if (motion != MotionSource::ticks) r.ticks.clear();
  if (motion != MotionSource::wheels) r.wheels.clear();
  if (motion != MotionSource::wheel_speeds) r.wheel_speeds.clear();
  if (motion != MotionSource::odometry) r.odometry.clear();
}

MotionSource motion_for(Form form) {
  if (form == Form::wheels) return MotionSource::wheels;
  if (form == Form::wheel_speeds) return MotionSource::wheel_speeds;
  if (form == Form::odometry) return MotionSource::odometry;
  return MotionSource::ticks;
}

/// A sound recording that has the form; times are dates.
Recording told_as(Form form) {
  Recording r = drive().recording;
  r.discarded.clear();
  r.choices.clear();
  for (auto& tick : r.ticks) tick.t += 1.7e9;
  for (auto& scan : r.scans) scan.t += 1.7e9;
  if (form == Form::pose) {
    r.scans.clear();
    for (std::size_t k = 0; k < drive().path.size(); k += 5) {
      const sim::TruthSample& truth = drive().path[k];
      // Poses to a tenth of a millimetre, as trackers tell them.
      const auto rounded = [](double value) { return 1e-4 * std::round(1e4 * value); };
      r.poses.push_back(
          {truth.t + 1.7e9, rounded(truth.pose.x), rounded(truth.pose.y), rounded(truth.pose.yaw)});
    }
  }
  tell_wheels(r, motion_for(form));
  return r;
}

// --- What a fault does ------------------------------------------------------------------------------------

template <typename Visit>
void each_sample(Recording& r, Form form, Visit visit) {
  const auto all = [&](auto& samples) {
    for (std::size_t k = 0; k < samples.size(); ++k) visit(samples[k], k, samples.size());
  };
  if (form == Form::ticks) all(r.ticks);
  if (form == Form::wheels) all(r.wheels);
  if (form == Form::wheel_speeds) all(r.wheel_speeds);
  if (form == Form::odometry) all(r.odometry);
  if (form == Form::pose) all(r.poses);
  if (form == Form::scan) all(r.scans);
}

using StampEdit = std::function<double(double t, std::size_t k, std::size_t count)>;

std::function<void(Recording&, Form)> stamps(const StampEdit& edit) {
  return [edit](Recording& r, Form form) {
    each_sample(r, form,
                [&](auto& sample, std::size_t k, std::size_t count) { sample.t = edit(sample.t, k, count); });
  };
}

/// Both wheels of the form, as numbers of its own unit.
void each_wheels(Recording& r, Form form, const std::function<void(double&, double&)>& edit) {
  const auto all = [&](auto& samples) {
    for (auto& sample : samples) {
      auto left = static_cast<double>(sample.left), right = static_cast<double>(sample.right);
      edit(left, right);
      sample.left = static_cast<std::remove_reference_t<decltype(sample.left)>>(left);
      sample.right = static_cast<std::remove_reference_t<decltype(sample.right)>>(right);
    }
  };
  if (form == Form::ticks) all(r.ticks);
  if (form == Form::wheels) all(r.wheels);
  if (form == Form::wheel_speeds) all(r.wheel_speeds);
}

void each_pose(Recording& r, Form form, const std::function<void(PoseSample&)>& edit) {
  for (PoseSample& pose : form == Form::pose ? r.poses : r.odometry) edit(pose);
}

template <typename Samples>
void write_zeros_between(Samples& samples) {
  Samples out;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    out.push_back(samples[k]);
    if (k % 4 != 0 || k + 1 == samples.size()) continue;
    typename Samples::value_type zero;
    zero.t = 0.5 * (samples[k].t + samples[k + 1].t);
    out.push_back(zero);
  }
  samples = std::move(out);
}

void second_writer(Recording& r, Form form) {
  if (form == Form::ticks) write_zeros_between(r.ticks);
  if (form == Form::wheels) write_zeros_between(r.wheels);
  if (form == Form::wheel_speeds) write_zeros_between(r.wheel_speeds);
  if (form == Form::odometry) write_zeros_between(r.odometry);
  if (form == Form::pose) write_zeros_between(r.poses);
}

void out_of_order(Recording& r, Form form) {
  const auto delay = [](auto& samples, std::size_t by) {
    for (std::size_t k = 0; k + by < samples.size(); k += 2 * by)
      std::rotate(samples.begin() + static_cast<std::ptrdiff_t>(k),
                  samples.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                  samples.begin() + static_cast<std::ptrdiff_t>(k + by));
  };
  // Two seconds and more, at the rate of each form.
  if (form == Form::ticks) delay(r.ticks, 150);
  if (form == Form::wheels) delay(r.wheels, 150);
  if (form == Form::wheel_speeds) delay(r.wheel_speeds, 150);
  if (form == Form::odometry) delay(r.odometry, 150);
  if (form == Form::pose) delay(r.poses, 40);
  if (form == Form::scan) delay(r.scans, 40);
}

void repeated(Recording& r, Form form) {
  for (std::size_t k = 1; form == Form::scan && k < r.scans.size(); k += 3)
    r.scans[k].ranges = r.scans[k - 1].ranges;
  for (std::size_t k = 1; form == Form::pose && k < r.poses.size(); k += 3) {
    const double t = r.poses[k].t;
    r.poses[k] = r.poses[k - 1];
    r.poses[k].t = t;
  }
}

/// A second lidar on the same topic that looks backwards.
void two_sensors(Recording& r, Form) {
  std::vector<Scan> both;
  for (std::size_t k = 0; k < r.scans.size(); ++k) {
    r.scans[k].sensor = "front";
    both.push_back(r.scans[k]);
    if (k % 5 == 0) continue;
    Scan rear = r.scans[k];
    rear.sensor = "rear";
    rear.t += 0.03;
    rear.angle_min += kPi;
    both.push_back(rear);
  }
  r.scans = std::move(both);
}

void another_unit(Recording& r, Form form) {
  const auto times = [](double factor) {
    return [factor](double& left, double& right) { left *= factor, right *= factor; };
  };
  if (form == Form::ticks) each_wheels(r, form, times(4.0));
  if (form == Form::wheels) each_wheels(r, form, times(180.0 / kPi));
  if (form == Form::wheel_speeds) each_wheels(r, form, times(60.0 / kTurn));
  if (form == Form::odometry) each_pose(r, form, [](PoseSample& p) { p.x *= 100.0, p.y *= 100.0; });
  if (form == Form::pose) each_pose(r, form, [](PoseSample& p) { p.x *= 1000.0, p.y *= 1000.0; });
  for (Scan& scan : r.scans) {
    if (form != Form::scan) break;
    for (float& range : scan.ranges) range *= 1000.0F;
    scan.range_min *= 1000.0, scan.range_max *= 1000.0;
  }
}

/// A frame that is turned by five degrees; of a reference it also sits elsewhere.
void another_frame(Recording& r, Form form) {
  constexpr double kTurned = 5.0 * kPi / 180.0;
  each_pose(r, form, [&](PoseSample& p) {
    if (form == Form::pose) {
      p.x += 0.12 * std::cos(p.yaw) - 0.05 * std::sin(p.yaw);
      p.y += 0.12 * std::sin(p.yaw) + 0.05 * std::cos(p.yaw);
    }
    p.yaw += kTurned;
  });
}

void wrapped(Recording& r, Form form) {
  if (form == Form::ticks)
    for (TickSample& tick : r.ticks)
      tick.left = ((tick.left % 5000) + 5000) % 5000, tick.right = ((tick.right % 5000) + 5000) % 5000;
  if (form == Form::wheels)
    each_wheels(r, form, [](double& left, double& right) {
      left = std::remainder(left, kTurn), right = std::remainder(right, kTurn);
    });
  each_pose(r, form, [](PoseSample& p) { p.yaw = std::remainder(p.yaw, kTurn); });
}

void without_direction(Recording& r, Form form) {
  if (form == Form::wheel_speeds)
    return each_wheels(r, form,
                       [](double& left, double& right) { left = std::abs(left), right = std::abs(right); });
  double last_left = 0.0, last_right = 0.0, left_sum = 0.0, right_sum = 0.0;
  each_wheels(r, form, [&](double& left, double& right) {
    left_sum += std::abs(left - last_left), right_sum += std::abs(right - last_right);
    last_left = left, last_right = right;
    left = left_sum, right = right_sum;
  });
}

void exchanged(Recording& r, Form form) {
  each_wheels(r, form, [](double& left, double& right) { std::swap(left, right); });
  if (form == Form::odometry) each_pose(r, form, [](PoseSample& p) { p.y = -p.y, p.yaw = -p.yaw; });
}

void misread(Recording& r, Form form) {
  each_sample(r, form, [](auto& sample, std::size_t k, std::size_t count) {
    if (k % (count / 6) != count / 12) return;
    if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, TickSample>)
      sample.left += 3'000'000;
    else if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, WheelSample>)
      sample.left += 900.0;
    else if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, PoseSample>)
      sample.x += 30.0, sample.y -= 30.0;
    else
      for (std::size_t i = 0; i < sample.ranges.size(); ++i)
        sample.ranges[i] = static_cast<float>(1.0 + 0.001 * static_cast<double>(i * i % 1000));
  });
}

void in_parts(Recording& r, Form) {
  std::vector<Scan> parts;
  for (const Scan& scan : r.scans) {
    const std::size_t quarter = scan.ranges.size() / 4;
    for (std::size_t p = 0; p < 4; ++p) {
      Scan part = scan;
      const std::size_t begin = p * quarter, end = p == 3 ? scan.ranges.size() : begin + quarter;
      part.ranges.assign(scan.ranges.begin() + static_cast<std::ptrdiff_t>(begin),
                         scan.ranges.begin() + static_cast<std::ptrdiff_t>(end));
      part.intensities.clear();
      part.angle_min = scan.angle(begin);
      part.t += scan.time_increment.value_or(0.0) * static_cast<double>(begin);
      parts.push_back(std::move(part));
    }
  }
  r.scans = std::move(parts);
}

/// Turns of one beam more or less than the step says.
void wandering(Recording& r, Form) {
  for (std::size_t k = 0; k < r.scans.size(); ++k) {
    Scan& scan = r.scans[k];
    const auto given = scan.ranges.size();
    const auto beams = given + (k * k + k / 3) % 5 - 2;
    std::vector<float> ranges(beams);
    for (std::size_t i = 0; i < beams; ++i) {
      const double place = static_cast<double>(i * given) / static_cast<double>(beams);
      ranges[i] = scan.ranges[static_cast<std::size_t>(std::lround(place)) % given];
    }
    scan.ranges = std::move(ranges);
    scan.intensities.clear();
  }
}

void phantom(Recording& r, Form) {
  for (std::size_t k = 0; k < r.scans.size(); ++k)
    for (std::size_t i = 0; i < r.scans[k].ranges.size(); ++i)
      if ((i + 3 * k) % 9 == 0) r.scans[k].ranges[i] = 2.9F;
}

struct Trial {
  std::function<void(Recording&, Form)> make;
  std::string says;  ///< regular expression, of what is told or measured
  std::map<Form, std::string> says_of = {};
};

const std::map<std::string, Trial>& trials() {
  static const std::map<std::string, Trial> all = {
      {"lost_digits",
       {stamps([](double t, std::size_t, std::size_t) { return std::floor(t); }),
        "carry the same time stamp"}},
      {"clock_was_set",
       {stamps([](double t, std::size_t k, std::size_t count) { return k < count / 3 ? t - 1.7e9 : t; }),
        "counted since it was switched on"}},
      {"time_unit",
       {stamps([](double t, std::size_t, std::size_t) { return 1e3 * (t - 1.7e9); }),
        "look like milliseconds"}},
      {"clock_step",
       {stamps([](double t, std::size_t k, std::size_t count) { return k < count / 2 ? t : t + 0.4; }),
        "step by -?0\\.[34][0-9] s"}},
      {"clock_rate",
       {stamps([](double t, std::size_t, std::size_t) { return 1.7e9 + 1.6 * (t - 1.7e9); }),
        "clock of the|stamps of the scans run too slowly"}},
      {"order", {out_of_order, "out of order by more than 1 s"}},
      {"second_writer", {second_writer, "of a second program"}},
      {"repeated", {repeated, "same values as the one before"}},
      {"several_sources", {two_sensors, "front \\([0-9]+\\), rear"}},
      {"value_unit",
       {another_unit,
        "",
        {{Form::ticks, "one edge of a period, the recorded counts all four"},
         {Form::wheels, "look like degrees"},
         {Form::wheel_speeds, "look like rpm"},
         {Form::odometry, "look like centimetres"},
         {Form::pose, "in millimetres"},
         {Form::scan, "look like millimetres"}}}},
      {"heading_unit",
       {[](Recording& r, Form form) { each_pose(r, form, [](PoseSample& p) { p.yaw *= 180.0 / kPi; }); },
        "yaw looks like degrees"}},
      {"not_of_two_wheels",
       {another_frame, "goes sideways over 8\\.7 % of its way: its frame is turned 5\\.0"}},
      {"counter_wraps", {wrapped, ""}},
      {"no_direction", {without_direction, "only ever grow"}},
      {"exchanged", {exchanged, "exchanged|swapped|backwards|upside down"}},
      {"misread", {misread, ""}},
      {"parts", {in_parts, "a turn comes in 4 messages"}},
      {"wandering_head", {wandering, "one angle_increment"}},
      {"phantom", {phantom, "exactly 2.9 m"}}};
  return all;
}

/// Names of joints and frames are told by ROS recordings only:
/// tests/unit/proto/recording/ros_publishers_test.cpp.
bool is_tried_with_bags(const std::string& fault, Form form) {
  return fault == "several_sources" && form != Form::scan;
}

struct Outcome {
  Calibration calibration;
  std::string text;  ///< of the refusal, and of whatever was left out or put right
};

Outcome solved(const Recording& recording) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "drive.jsonl";
  EXPECT_TRUE(write_recording_jsonl(recording, path));
  Outcome outcome;
  const auto read = read_recording(path);
  if (!read) {
    outcome.text = read.error().text();
    return outcome;
  }
  outcome.calibration = calib::solve({&read.value(), 1}, {});
  for (const std::string& reason : outcome.calibration.reasons) outcome.text += reason + "\n";
  for (const Discarded& one : outcome.calibration.discarded)
    outcome.text += one.what + ": " + one.reason + "\n";
  for (const Repair& one : outcome.calibration.repairs)
    outcome.text += one.what + ": " + one.chosen + ", " + one.reason + "\n";
  return outcome;
}

void expect_right_lengths(const Outcome& outcome) {
  EXPECT_NE(outcome.calibration.verdict, Verdict::refused) << outcome.text;
  const sim::Geometry& truth = drive().truth;
  const auto expect_near = [&](const char* name, double value) {
    EXPECT_NEAR(outcome.calibration.parameter(name).value_or(0.0), value, kRight * value) << name << "\n"
                                                                                          << outcome.text;
  };
  expect_near("left_wheel_diameter", truth.left_diameter);
  expect_near("right_wheel_diameter", truth.right_diameter);
  expect_near("track_width", truth.track_width);
}

class FrontDoor : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] static Form form() { return static_cast<Form>(GetParam()); }
};

TEST_P(FrontDoor, says_nothing_of_a_sound_recording) {
  const Outcome outcome = solved(told_as(form()));
  expect_right_lengths(outcome);
  EXPECT_TRUE(outcome.calibration.repairs.empty()) << outcome.text;
  for (const auto& [name, trial] : trials()) {
    if (!trial.says.empty()) EXPECT_THAT(outcome.text, ::testing::Not(ContainsRegex(trial.says))) << name;
    for (const auto& [other, says] : trial.says_of)
      EXPECT_THAT(outcome.text, ::testing::Not(ContainsRegex(says))) << name;
  }
}

TEST_P(FrontDoor, tells_or_mends_every_fault_that_the_form_can_have) {
  for (const auto& fault : calib::ingest::faults()) {
    const auto& cell = fault.cells.at(GetParam());
    SCOPED_TRACE(std::string(fault.name) + " of " + name_of(form()));
    if (cell.answer == Answer::cannot) {
      EXPECT_STRNE(cell.words, "");
      continue;
    }
    if (is_tried_with_bags(fault.name, form())) continue;
    const auto trial = trials().find(fault.name);
    if (trial == trials().end()) {
      ADD_FAILURE() << "no trial of this fault";
      continue;
    }
    Recording recording = told_as(form());
    trial->second.make(recording, form());
    const Outcome outcome = solved(recording);
    const auto own = trial->second.says_of.find(form());
    const std::string& says = own == trial->second.says_of.end() ? trial->second.says : own->second;
    const bool of_poses_mended = std::string(fault.name) == "not_of_two_wheels" && form() == Form::pose;
    if (!says.empty() && !of_poses_mended) EXPECT_THAT(outcome.text, ContainsRegex(says));
    if (cell.answer == Answer::mended) expect_right_lengths(outcome);
    if (cell.answer == Answer::told) EXPECT_EQ(outcome.calibration.verdict, Verdict::refused) << outcome.text;
    // Never a wrong calibration: what is not refused is right.
    if (outcome.calibration.verdict != Verdict::refused) expect_right_lengths(outcome);
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, FrontDoor, ::testing::Range<std::size_t>(0, calib::ingest::kForms),
                         [](const auto& info) {
                           return std::string(name_of(static_cast<Form>(info.param)));
                         });

}  // namespace
}  // namespace odomcalib::front_door_test
