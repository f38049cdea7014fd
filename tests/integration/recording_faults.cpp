#include "tests/integration/recording_faults.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <type_traits>

namespace odomcalib::recording_faults {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTurn = 2.0 * kPi;
constexpr double kDate = 1.7e9;  // s since 1970

/// From one to another, in even ratios.
double between(double least, double most, double size) { return least * std::pow(most / least, size); }

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

using StampEdit = std::function<double(double t, bool is_after)>;

/// @param edit told whether the moment of the draw has passed
void edit_stamps(Recording& r, Form form, const Draw& draw, const StampEdit& edit) {
  each_sample(r, form, [&](auto& sample, std::size_t k, std::size_t count) {
    sample.t = edit(sample.t, static_cast<double>(k) >= draw.moment * static_cast<double>(count));
  });
}

void lose_digits(Recording& r, Form form, const Draw& draw) {
  const double step = between(1e-4, 1.0, draw.size);
  edit_stamps(r, form, draw, [=](double t, bool) { return step * std::floor(t / step); });
}

void set_clock(Recording& r, Form form, const Draw& draw) {
  edit_stamps(r, form, draw, [](double t, bool is_after) { return is_after ? t : t - kDate; });
}

void other_time_unit(Recording& r, Form form, const Draw& draw) {
  edit_stamps(r, form, draw, [](double t, bool) { return 1e3 * (t - kDate); });
}

void step_clock(Recording& r, Form form, const Draw& draw) {
  const double step = between(1e-3, 0.4, draw.size);
  edit_stamps(r, form, draw, [=](double t, bool is_after) { return is_after ? t + step : t; });
}

void rate_of_clock(Recording& r, Form form, const Draw& draw) {
  const double rate = 1.0 + between(1e-5, 0.6, draw.size);
  edit_stamps(r, form, draw, [=](double t, bool) { return kDate + rate * (t - kDate); });
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

/// @param every samples one of a second program
template <typename Samples>
void write_zeros_between(Samples& samples, std::size_t every) {
  Samples out;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    out.push_back(samples[k]);
    if (k % every != 0 || k + 1 == samples.size()) continue;
    typename Samples::value_type zero;
    zero.t = 0.5 * (samples[k].t + samples[k + 1].t);
    out.push_back(zero);
  }
  samples = std::move(out);
}

void second_writer(Recording& r, Form form, const Draw& draw) {
  const auto every = static_cast<std::size_t>(between(400.0, 4.0, draw.size));
  if (form == Form::ticks) write_zeros_between(r.ticks, every);
  if (form == Form::wheels) write_zeros_between(r.wheels, every);
  if (form == Form::wheel_speeds) write_zeros_between(r.wheel_speeds, every);
  if (form == Form::odometry) write_zeros_between(r.odometry, every);
  if (form == Form::pose) write_zeros_between(r.poses, every);
}

void out_of_order(Recording& r, Form form, const Draw& draw) {
  const double apart = between(20.0, 2.0, draw.size);
  const auto delay = [=](auto& samples, std::size_t by) {
    for (std::size_t k = 0; k + by < samples.size();
         k += static_cast<std::size_t>(apart * static_cast<double>(by)))
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

void repeated(Recording& r, Form form, const Draw& draw) {
  const auto every = static_cast<std::size_t>(between(100.0, 3.0, draw.size));
  for (std::size_t k = 1; form == Form::scan && k < r.scans.size(); k += every)
    r.scans[k].ranges = r.scans[k - 1].ranges;
  for (std::size_t k = 1; form == Form::pose && k < r.poses.size(); k += every) {
    const double t = r.poses[k].t;
    r.poses[k] = r.poses[k - 1];
    r.poses[k].t = t;
  }
}

/// A second lidar on the same topic that looks backwards.
void two_sensors(Recording& r, Form, const Draw& draw) {
  const double share = between(0.02, 0.8, draw.size);
  double due = 0.0;
  std::vector<Scan> both;
  for (std::size_t k = 0; k < r.scans.size(); ++k) {
    r.scans[k].sensor = "front";
    both.push_back(r.scans[k]);
    if ((due += share) < 1.0) continue;
    due -= 1.0;
    Scan rear = r.scans[k];
    rear.sensor = "rear";
    rear.t += 0.03;
    rear.angle_min += kPi;
    both.push_back(rear);
  }
  r.scans = std::move(both);
}

void another_unit(Recording& r, Form form, const Draw&) {
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
void another_frame(Recording& r, Form form, const Draw& draw) {
  const double turned = between(0.05, 5.0, draw.size) * kPi / 180.0;
  each_pose(r, form, [&](PoseSample& p) {
    if (form == Form::pose) {
      p.x += 0.12 * std::cos(p.yaw) - 0.05 * std::sin(p.yaw);
      p.y += 0.12 * std::sin(p.yaw) + 0.05 * std::cos(p.yaw);
    }
    p.yaw += turned;
  });
}

void wrapped(Recording& r, Form form, const Draw& draw) {
  const std::int64_t modulus = std::llround(between(100000.0, 5000.0, draw.size));
  if (form == Form::ticks)
    for (TickSample& tick : r.ticks)
      tick.left = (tick.left % modulus + modulus) % modulus,
      tick.right = (tick.right % modulus + modulus) % modulus;
  if (form == Form::wheels)
    each_wheels(r, form, [](double& left, double& right) {
      left = std::remainder(left, kTurn), right = std::remainder(right, kTurn);
    });
  each_pose(r, form, [](PoseSample& p) { p.yaw = std::remainder(p.yaw, kTurn); });
}

void without_direction(Recording& r, Form form, const Draw&) {
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

void exchanged(Recording& r, Form form, const Draw&) {
  each_wheels(r, form, [](double& left, double& right) { std::swap(left, right); });
  if (form == Form::odometry) each_pose(r, form, [](PoseSample& p) { p.y = -p.y, p.yaw = -p.yaw; });
}

void misread(Recording& r, Form form, const Draw& draw) {
  const double size = between(1e-5, 1.0, draw.size);
  each_sample(r, form, [=](auto& sample, std::size_t k, std::size_t count) {
    if (k % (count / 6) != count / 12) return;
    if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, TickSample>)
      sample.left += std::llround(3e6 * size);
    else if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, WheelSample>)
      sample.left += 900.0 * size;
    else if constexpr (std::is_same_v<std::decay_t<decltype(sample)>, PoseSample>)
      sample.x += 30.0 * size, sample.y -= 30.0 * size;
    else
      for (std::size_t i = 0; i < sample.ranges.size(); ++i)
        sample.ranges[i] = static_cast<float>(1.0 + 0.001 * static_cast<double>(i * i % 1000));
  });
}

void in_parts(Recording& r, Form, const Draw& draw) {
  const auto count = static_cast<std::size_t>(std::lround(between(10.0, 4.0, draw.size)));
  std::vector<Scan> parts;
  for (const Scan& scan : r.scans) {
    const std::size_t length = scan.ranges.size() / count;
    for (std::size_t p = 0; p < count; ++p) {
      Scan part = scan;
      const std::size_t begin = p * length, end = p + 1 == count ? scan.ranges.size() : begin + length;
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
void wandering(Recording& r, Form, const Draw& draw) {
  const auto most = static_cast<std::size_t>(between(1.0, 2.0, draw.size));
  for (std::size_t k = 0; k < r.scans.size(); ++k) {
    Scan& scan = r.scans[k];
    const auto given = scan.ranges.size();
    const auto beams = given + (k * k + k / 3) % (2 * most + 1) - most;
    std::vector<float> ranges(beams);
    for (std::size_t i = 0; i < beams; ++i) {
      const double place = static_cast<double>(i * given) / static_cast<double>(beams);
      ranges[i] = scan.ranges[static_cast<std::size_t>(std::lround(place)) % given];
    }
    scan.ranges = std::move(ranges);
    scan.intensities.clear();
  }
}

void phantom(Recording& r, Form, const Draw& draw) {
  const auto every = static_cast<std::size_t>(between(2000.0, 9.0, draw.size));
  for (std::size_t k = 0; k < r.scans.size(); ++k)
    for (std::size_t i = 0; i < r.scans[k].ranges.size(); ++i)
      if ((i + 3 * k) % every == 0) r.scans[k].ranges[i] = 2.9F;
}

void yaw_in_degrees(Recording& r, Form form, const Draw&) {
  each_pose(r, form, [](PoseSample& p) { p.yaw *= 180.0 / kPi; });
}

}  // namespace

Recording told_as(const sim::SimulatedRun& drive, Form form) {
  Recording r = drive.recording;
  r.discarded.clear();
  r.choices.clear();
  for (auto& tick : r.ticks) tick.t += kDate;
  for (auto& scan : r.scans) scan.t += kDate;
  if (form == Form::pose) {
    r.scans.clear();
    for (std::size_t k = 0; k < drive.path.size(); k += 5) {
      const sim::TruthSample& truth = drive.path[k];
      // Poses to a tenth of a millimetre, as trackers tell them.
      const auto rounded = [](double value) { return 1e-4 * std::round(1e4 * value); };
      r.poses.push_back(
          {truth.t + kDate, rounded(truth.pose.x), rounded(truth.pose.y), rounded(truth.pose.yaw)});
    }
  }
  tell_wheels(r, motion_for(form));
  return r;
}

const std::map<std::string, Make>& makers() {
  static const std::map<std::string, Make> all = {{"lost_digits", lose_digits},
                                                  {"clock_was_set", set_clock},
                                                  {"time_unit", other_time_unit},
                                                  {"clock_step", step_clock},
                                                  {"clock_rate", rate_of_clock},
                                                  {"order", out_of_order},
                                                  {"second_writer", second_writer},
                                                  {"repeated", repeated},
                                                  {"several_sources", two_sensors},
                                                  {"value_unit", another_unit},
                                                  {"heading_unit", yaw_in_degrees},
                                                  {"not_of_two_wheels", another_frame},
                                                  {"counter_wraps", wrapped},
                                                  {"no_direction", without_direction},
                                                  {"exchanged", exchanged},
                                                  {"misread", misread},
                                                  {"parts", in_parts},
                                                  {"wandering_head", wandering},
                                                  {"phantom", phantom}};
  return all;
}

}  // namespace odomcalib::recording_faults
