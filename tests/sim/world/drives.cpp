#include "tests/sim/world/drives.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>

#include "tests/sim/world/random.hpp"

namespace odomcalib::sim {

namespace {

/// A list of manoeuvres in the making.
struct Pattern {
  double rest = 0.0;  ///< s
  std::vector<Manoeuvre> list{{0.0, 0.0, 1.0}};

  void move(const Manoeuvre& one) { list.push_back(one); }

  /// There and back again, with a pause at each end when `stop` is set.
  void shuttle(double speed, double yaw_rate, double duration, bool stop) {
    for (const double way : {1.0, -1.0}) {
      list.push_back({way * speed, way * yaw_rate, duration});
      if (stop) list.push_back({0.0, 0.0, rest});
    }
  }

  void turn(double yaw_rate, double angle) {
    list.push_back({0.0, yaw_rate, angle / std::abs(yaw_rate)});
    list.push_back({0.0, 0.0, rest});
  }
};

struct Wanderer {
  Geometry nominal;
  double radius;
  Random random;
  Manoeuvre now;
  double until = 0.0;

  Manoeuvre candidate() {
    const int kind = std::uniform_int_distribution<int>(0, 9)(random);
    const double way = uniform(random, 0.0, 1.0) < 0.6 ? 1.0 : -1.0,
                 hand = uniform(random, 0.0, 1.0) < 0.5 ? 1.0 : -1.0;
    if (kind == 0) return {0.0, 0.0, uniform(random, 0.3, 0.8)};
    if (kind <= 3) return {0.0, hand * uniform(random, 0.3, 1.3), uniform(random, 1.0, 3.0)};
    if (kind <= 6) return {way * uniform(random, 0.1, 0.5), 0.0, uniform(random, 1.0, 4.0)};
    return {way * uniform(random, 0.1, 0.4), hand * uniform(random, 0.2, 1.0), uniform(random, 1.0, 4.0)};
  }

  /// From outside, it may come back in.
  [[nodiscard]] bool stays_inside(Pose pose, const Manoeuvre& move) const {
    constexpr double kStep = 0.1;
    const double farthest = std::max(radius, std::hypot(pose.x, pose.y));
    for (double t = 0.0; t < move.duration + 0.3; t += kStep) {
      pose = compose(pose, {move.speed * kStep, 0.0, move.yaw_rate * kStep});
      if (std::hypot(pose.x, pose.y) > farthest) return false;
    }
    return true;
  }

  void choose(const Pose& pose) {
    for (int tries = 0; tries < 50; ++tries) {
      now = candidate();
      if (stays_inside(pose, now)) return;
    }
    now = {0.0, 0.7, 1.0};  // hemmed in: turn and look again
  }

  WheelCommand operator()(double t, const Pose& odometry) {
    if (t >= until) {
      choose(odometry);
      until = t + now.duration;
    }
    return wheel_command(nominal, now.speed, now.yaw_rate);
  }
};

/// Forward to where it likes; where the area ends it turns on the spot and goes on.
struct Tourist {
  Geometry nominal;
  double radius;
  Random random;
  Manoeuvre now;
  double until = 0.0;
  std::optional<double> wanted_yaw;

  [[nodiscard]] bool leaves(const Pose& pose) const {
    constexpr double kAhead = 0.5;  // m
    const Pose ahead = compose(pose, {kAhead, 0.0, 0.0});
    const double distance = std::hypot(ahead.x, ahead.y);
    return distance > radius && distance > std::hypot(pose.x, pose.y);
  }

  void choose() {
    const double kind = uniform(random, 0.0, 1.0);
    now = {uniform(random, 0.15, 0.5), kind < 0.4 ? 0.0 : uniform(random, -0.5, 0.5),
           uniform(random, 1.5, 5.0)};
    if (kind > 0.9) now.speed = now.yaw_rate = 0.0;
  }

  /// rad/s, slower towards the end; zero when it is there.
  [[nodiscard]] double turn_rate(const Pose& pose) const {
    constexpr double kFastest = 0.8, kSlowest = 0.15, kThere = 0.05;
    const double left = std::remainder(*wanted_yaw - pose.yaw, 2.0 * std::numbers::pi);
    return std::abs(left) < kThere ? 0.0 : std::copysign(std::min(kFastest, kSlowest + std::abs(left)), left);
  }

  WheelCommand operator()(double t, const Pose& odometry) {
    if (!wanted_yaw && leaves(odometry))
      wanted_yaw = std::atan2(-odometry.y, -odometry.x) + uniform(random, -0.7, 0.7);
    if (wanted_yaw) {
      const double rate = turn_rate(odometry);
      if (rate != 0.0) return wheel_command(nominal, 0.0, rate);
      wanted_yaw.reset();
      until = t;
    }
    if (t >= until) {
      choose();
      until = t + now.duration;
    }
    return wheel_command(nominal, now.speed, now.yaw_rate);
  }
};

}  // namespace

WheelCommand wheel_command(const Geometry& nominal, double speed, double yaw_rate) {
  const double edge = 0.5 * nominal.track_width * yaw_rate;
  return {(speed - edge) / (0.5 * nominal.left_diameter), (speed + edge) / (0.5 * nominal.right_diameter)};
}

double way_of(const Manoeuvre& move) { return 0.5 * (move.from + move.to) * move.speed * move.duration; }

double total_duration(const std::vector<Manoeuvre>& manoeuvres) {
  double sum = 0.0;
  for (const Manoeuvre& move : manoeuvres) sum += move.duration;
  return sum;
}

Drive follow(const Geometry& nominal, std::vector<Manoeuvre> manoeuvres) {
  return [nominal, list = std::move(manoeuvres)](double t, const Pose&) {
    double begin = 0.0;
    for (const Manoeuvre& move : list) {
      if (t < begin + move.duration) {
        const double share = move.from + (move.to - move.from) * (t - begin) / move.duration;
        return wheel_command(nominal, share * move.speed, share * move.yaw_rate);
      }
      begin += move.duration;
    }
    return WheelCommand{};
  };
}

std::vector<Manoeuvre> guided_pattern(double rest) {
  Pattern pattern{rest};
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  for (int heading = 0; heading < 4; ++heading) {
    const bool stop = heading % 2 == 0;
    pattern.shuttle(0.15, 0.0, 4.0, stop);
    pattern.shuttle(0.25, 0.0, 3.2, !stop);
    pattern.shuttle(0.45, 0.0, 2.2, stop);
    pattern.move({0.15, 0.0, 1.5});  // from slow to fast without a stop
    pattern.move({0.40, 0.0, 1.2});
    pattern.move({-0.40, 0.0, 1.2});
    pattern.move({-0.15, 0.0, 1.5});
    pattern.turn(heading % 2 == 0 ? 0.8 : 0.5, kQuarter);
  }
  for (const double rate : {0.3, 0.8, 1.3}) {
    pattern.turn(rate, 4.0 * kQuarter);
    pattern.turn(-rate, 4.0 * kQuarter);
  }
  for (const double speed : {0.15, 0.35})
    for (const double yaw_rate : {0.4, -0.4, 0.9, -0.9})
      for (const double way : {1.0, -1.0}) pattern.shuttle(way * speed, way * yaw_rate, 2.2, false);
  for (const double speed : {0.12, -0.12, 0.2}) {  // one wheel stands still
    pattern.shuttle(speed, speed / 0.2, 2.0, true);
    pattern.shuttle(speed, -speed / 0.2, 2.0, true);
  }
  pattern.shuttle(0.25, 0.0, 3.2, true);
  pattern.move({0.0, 0.0, 1.0});
  return pattern.list;
}

namespace {

/// Rests and pushes of all lengths, by turns.
class VariedPattern {
 public:
  VariedPattern() : list_{{0.0, 0.0, 1.0}} {}

  /// There and back again over the same way.
  void shuttle(double speed, double yaw_rate, double duration) {
    for (const double way : {1.0, -1.0}) move(way * speed, way * yaw_rate, duration);
  }

  void turn(double yaw_rate, double angle) { move(0.0, yaw_rate, angle / std::abs(yaw_rate)); }

  /// From rest through every speed up to this one, and from there to rest at once.
  void sweep(double speed, double yaw_rate, double duration) {
    for (const double way : {1.0, -1.0}) {
      list_.push_back({way * speed, way * yaw_rate, duration, 0.0, 1.0});
      rest();
    }
  }

  /// Without a rest before or after it.
  void pass(const Manoeuvre& one) { list_.push_back(one); }

  void rest() {
    constexpr double kRests[] = {0.8, 0.5, 1.2, 0.65, 0.35};  // s, braking included
    list_.push_back({0.0, 0.0, kRests[rests_++ % std::size(kRests)]});
  }

  std::vector<Manoeuvre> take() { return std::move(list_); }

 private:
  /// Over the way that a push without delay would go.
  void move(double speed, double yaw_rate, double duration) {
    constexpr double kPushes[] = {0.0, 0.8, 0.3, 1.5};  // s until the speed is reached
    const double push = std::min(kPushes[pushes_++ % std::size(kPushes)], duration);
    if (push > 0.0) list_.push_back({speed, yaw_rate, push, 0.0, 1.0});
    list_.push_back({speed, yaw_rate, duration - 0.5 * push});
    rest();
  }

  std::vector<Manoeuvre> list_;
  std::size_t rests_ = 0, pushes_ = 0;
};

void drive_heading(VariedPattern& pattern, int heading) {
  constexpr double kSpeeds[] = {0.15, 0.25, 0.4, 0.2};
  const double speed = kSpeeds[heading];
  pattern.shuttle(speed, 0.0, 0.7 / speed);
  pattern.sweep(0.5, 0.0, 3.6);
  if (heading % 2 == 0) pattern.sweep(-0.35, 0.0, 4.5);
  pattern.pass({0.15, 0.0, 1.5});  // from slow to fast without a stop
  pattern.pass({0.40, 0.0, 1.2});
  pattern.pass({-0.40, 0.0, 1.2});
  pattern.pass({-0.15, 0.0, 1.5});
}

}  // namespace

std::vector<Manoeuvre> varied_pattern() {
  VariedPattern pattern;
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  for (int heading = 0; heading < 4; ++heading) {
    drive_heading(pattern, heading);
    pattern.turn(heading % 2 == 0 ? 0.8 : 0.5, kQuarter);
  }
  pattern.sweep(0.0, 1.3, 8.0);
  pattern.sweep(0.0, -1.3, 6.0);
  for (const double hand : {1.0, -1.0}) {
    pattern.turn(hand * 0.3, 2.0 * kQuarter);
    pattern.turn(hand * 0.8, 4.0 * kQuarter);
  }
  for (const double speed : {0.15, 0.35})
    for (const double yaw_rate : {0.4, -0.4, 0.9, -0.9}) pattern.shuttle(speed, yaw_rate, 2.0);
  for (const double speed : {0.12, -0.12, 0.2}) {  // one wheel stands still
    pattern.shuttle(speed, speed / 0.2, 1.8);
    pattern.shuttle(speed, -speed / 0.2, 1.8);
  }
  pattern.shuttle(0.25, 0.0, 2.8);
  pattern.pass({0.0, 0.0, 1.0});
  return pattern.take();
}

std::vector<Manoeuvre> lazy_pattern() {
  std::vector<Manoeuvre> list{{0.0, 0.0, 1.0}};
  for (int lap = 0; lap < 10; ++lap) {
    const double hand = lap % 2 == 0 ? 1.0 : -1.0;
    list.push_back({0.25, 0.0, 3.0});
    list.push_back({0.25, hand * 0.4, std::numbers::pi / 0.4});
    list.push_back({0.25, 0.0, 3.0});
    list.push_back({0.25, hand * 0.4, std::numbers::pi / 0.4});
  }
  list.push_back({0.0, 0.0, 1.0});
  return list;
}

Drive random_drive(const Geometry& nominal, std::uint64_t seed, double radius) {
  auto wanderer =
      std::make_shared<Wanderer>(Wanderer{nominal, radius, Random(seed ^ 0x6472697665ULL), Manoeuvre{}, 0.0});
  return [wanderer](double t, const Pose& odometry) { return (*wanderer)(t, odometry); };
}

Drive tour_drive(const Geometry& nominal, std::uint64_t seed, double radius) {
  auto tourist = std::make_shared<Tourist>(
      Tourist{nominal, radius, Random(seed ^ 0x746f7572ULL), Manoeuvre{}, 0.0, std::nullopt});
  return [tourist](double t, const Pose& odometry) { return (*tourist)(t, odometry); };
}

}  // namespace odomcalib::sim
