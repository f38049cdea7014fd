// Corrected odometry in C++ (17 or later): odometry.h with handles that close themselves and results that
// hold either a value or what is wrong.
#pragma once

#include <odomcalib/odometry.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace odomcalib {

/// An error: a status of odometry.h and the reason in words.
struct Problem {
  int status = ODOMCALIB_OK;
  std::string text;
};

/// Either a value or a Problem, as std::expected of C++23. Look at it before its value is taken.
template <typename T>
class Expected {
 public:
  Expected(T value) : state_(std::move(value)) {}            // NOLINT(google-explicit-constructor)
  Expected(Problem problem) : state_(std::move(problem)) {}  // NOLINT(google-explicit-constructor)
  [[nodiscard]] bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  T& value() {
    assert(has_value());
    return *std::get_if<0>(&state_);
  }
  T& operator*() { return value(); }
  T* operator->() { return &value(); }
  [[nodiscard]] const Problem& error() const {
    assert(!has_value());
    return *std::get_if<1>(&state_);
  }

 private:
  std::variant<T, Problem> state_;
};

struct Pose {
  double x = 0.0, y = 0.0;  ///< m
  double yaw = 0.0;         ///< rad
};

struct Velocity {
  double forward = 0.0, left = 0.0;  ///< m/s
  double yaw_rate = 0.0;             ///< rad/s
};

/// Row by row.
using Covariance = std::array<double, 9>;

/// A running drive; see odometry.h for what each call does. Moved, not copied; one thread at a time.
class Odometry {
 public:
  static Expected<Odometry> open(const std::string& path,
                                 const odomcalib_options& options = ODOMCALIB_OPTIONS_INIT) {
    return opened([&](odomcalib_odometry** handle, char* problem, std::size_t size) {
      return odomcalib_odometry_open(path.c_str(), &options, handle, problem, size);
    });
  }
  static Expected<Odometry> from_text(const std::string& text,
                                      const odomcalib_options& options = ODOMCALIB_OPTIONS_INIT) {
    return opened([&](odomcalib_odometry** handle, char* problem, std::size_t size) {
      return odomcalib_odometry_open_text(text.data(), text.size(), &options, handle, problem, size);
    });
  }

  /// Each returns a status; problem() has the words.
  [[nodiscard]] int update_counts(double stamp, std::int64_t left, std::int64_t right) {
    return odomcalib_odometry_update_counts(get(), stamp, left, right);
  }
  [[nodiscard]] int update_angles(double stamp, double left, double right) {
    return odomcalib_odometry_update_angles(get(), stamp, left, right);
  }
  [[nodiscard]] int update_speeds(double stamp, double left, double right) {
    return odomcalib_odometry_update_speeds(get(), stamp, left, right);
  }
  void restart() { (void)odomcalib_odometry_restart(get()); }
  [[nodiscard]] int set_pose(const Pose& pose) {
    const double values[3] = {pose.x, pose.y, pose.yaw};
    return odomcalib_odometry_set_pose(get(), values);
  }

  /// s, of the last sample that was taken in.
  [[nodiscard]] double stamp() const { return odomcalib_odometry_stamp(get()); }
  [[nodiscard]] Pose pose() const {
    double p[3];
    (void)odomcalib_odometry_pose(get(), p);
    return {p[0], p[1], p[2]};
  }
  [[nodiscard]] Velocity velocity() const {
    double v[3];
    (void)odomcalib_odometry_velocity(get(), v);
    return {v[0], v[1], v[2]};
  }
  /// The part that is known, where the calibration does not have all of it (covariance_is_whole).
  [[nodiscard]] Covariance covariance() const {
    Covariance c{};
    (void)odomcalib_odometry_covariance(get(), c.data());
    return c;
  }
  [[nodiscard]] Covariance velocity_covariance() const {
    Covariance c{};
    (void)odomcalib_odometry_velocity_covariance(get(), c.data());
    return c;
  }
  [[nodiscard]] bool covariance_is_whole() const {
    Covariance c{};
    return odomcalib_odometry_covariance(get(), c.data()) == ODOMCALIB_OK;
  }

  [[nodiscard]] Expected<Pose> lidar_pose() const {
    double p[3];
    const int status = odomcalib_odometry_lidar_pose(get(), p);
    if (status != ODOMCALIB_OK) return Problem{status, "the calibration has no lidar pose"};
    return Pose{p[0], p[1], p[2]};
  }
  /// s: a scan stamped t was taken at t - offset by the encoders' clock.
  [[nodiscard]] double clock_offset() const { return odomcalib_odometry_clock_offset(get()); }
  /// In place: rad and m.
  void correct_beams(std::vector<float>& bearings, std::vector<float>& ranges) const {
    assert(bearings.size() == ranges.size());
    (void)odomcalib_odometry_correct_beams(get(), ranges.size(), bearings.data(), ranges.data(),
                                           bearings.data(), ranges.data());
  }

  /// Texts are valid as long as this object.
  [[nodiscard]] std::vector<odomcalib_effect> effects() const {
    std::vector<odomcalib_effect> all(odomcalib_odometry_effect_count(get()));
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k].size = sizeof(odomcalib_effect);
      (void)odomcalib_odometry_effect(get(), k, &all[k]);
    }
    return all;
  }
  [[nodiscard]] const char* problem() const { return odomcalib_odometry_problem(get()); }

 private:
  struct Close {
    void operator()(odomcalib_odometry* handle) const { odomcalib_odometry_close(handle); }
  };
  explicit Odometry(odomcalib_odometry* handle) : handle_(handle) {}
  [[nodiscard]] odomcalib_odometry* get() const { return handle_.get(); }

  template <typename Open>
  static Expected<Odometry> opened(Open open_with) {
    odomcalib_odometry* handle = nullptr;
    char problem[512] = "";
    const int status = open_with(&handle, problem, sizeof(problem));
    if (status != ODOMCALIB_OK) return Problem{status, problem};
    return Odometry(handle);
  }

  std::unique_ptr<odomcalib_odometry, Close> handle_;
};

}  // namespace odomcalib
