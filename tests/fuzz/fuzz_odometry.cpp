// The C interface of the library: a calibration, then calls in any order with hostile samples. Whatever
// comes, no number that is none goes out, and a sample that was refused leaves the pose as it was.
#include <odomcalib/odometry.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "tests/fuzz/share.hpp"

namespace {

using odomcalib::fuzz::require;

/// Rest of the input, taken from the front; zeros once it has come to its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] bool empty() const { return size_ == 0; }
  template <typename T>
  T take() {
    T value{};
    const std::size_t length = std::min(sizeof(T), size_);
    std::memcpy(&value, data_, length);
    data_ += length;
    size_ -= length;
    return value;
  }
  /// Up to a zero, which goes too.
  std::string take_text() {
    const auto* end = static_cast<const std::uint8_t*>(size_ > 0 ? std::memchr(data_, 0, size_) : nullptr);
    const std::size_t length = end != nullptr ? static_cast<std::size_t>(end - data_) : size_;
    std::string text(reinterpret_cast<const char*>(data_), length);
    data_ += std::min(length + 1, size_);
    size_ -= std::min(length + 1, size_);
    return text;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

template <std::size_t N>
void require_finite(const std::array<double, N>& values) {
  for (const double value : values) require(std::isfinite(value));
}

std::array<double, 3> pose_of(const odomcalib_odometry* odometry) {
  std::array<double, 3> pose{};
  require(odomcalib_odometry_pose(odometry, pose.data()) == ODOMCALIB_OK);
  require_finite(pose);
  return pose;
}

void ask(const odomcalib_odometry* odometry) {
  std::array<double, 3> three{};
  std::array<double, 9> nine{};
  odomcalib_odometry_velocity(odometry, three.data());
  require_finite(three);
  odomcalib_odometry_covariance(odometry, nine.data());
  require_finite(nine);
  odomcalib_odometry_velocity_covariance(odometry, nine.data());
  require_finite(nine);
  odomcalib_odometry_lidar_pose(odometry, three.data());
  require_finite(three);
  require(std::isfinite(odomcalib_odometry_stamp(odometry)));
  for (std::size_t k = 0; k < odomcalib_odometry_effect_count(odometry); ++k) {
    odomcalib_effect effect{};
    effect.size = sizeof(effect);
    require(odomcalib_odometry_effect(odometry, k, &effect) == ODOMCALIB_OK);
    require(std::strlen(effect.name) > 0 &&
            (effect.place != ODOMCALIB_LEFT_OUT || std::strlen(effect.why) > 0));
  }
}

void look_at_beam(const odomcalib_odometry* odometry, Bytes& bytes) {
  auto bearing = bytes.take<float>(), range = bytes.take<float>();
  odomcalib_odometry_correct_beams(odometry, 1, &bearing, &range, &bearing, &range);
}

/// Samples of a recording, from what is left.
void look_at_path(const odomcalib_odometry* odometry, Bytes& bytes) {
  constexpr std::size_t kMost = 64;
  std::vector<double> stamps, poses;
  std::vector<std::int64_t> left, right;
  while (!bytes.empty() && stamps.size() < kMost) {
    stamps.push_back(0.001 * bytes.take<std::int16_t>());
    left.push_back(bytes.take<std::int16_t>());
    right.push_back(bytes.take<std::int64_t>());
  }
  poses.resize(3 * stamps.size());
  odomcalib_odometry_path(odometry, stamps.size(), stamps.data(), left.data(), right.data(), poses.data());
  for (const double value : poses) require(std::isfinite(value));
}

void call(odomcalib_odometry* odometry, Bytes& bytes, double& stamp) {
  const auto before = pose_of(odometry);
  int status = ODOMCALIB_OK;
  const auto kind = bytes.take<std::uint8_t>();
  // Mostly stamps that rise by little, as those of samples do.
  stamp = (kind & 0x80) != 0 ? bytes.take<double>() : stamp + 0.001 * bytes.take<std::uint8_t>();
  switch (kind & 0x0f) {
    case 0:
      status = odomcalib_odometry_update_counts(odometry, stamp, bytes.take<std::int64_t>(),
                                                bytes.take<std::int64_t>());
      break;
    case 1:
      status = odomcalib_odometry_update_angles(odometry, stamp, bytes.take<double>(), bytes.take<double>());
      break;
    case 2:
      status = odomcalib_odometry_update_speeds(odometry, stamp, bytes.take<double>(), bytes.take<double>());
      break;
    case 3:
      status = odomcalib_odometry_restart(odometry);
      break;
    case 4: {
      const std::array<double, 3> pose = {bytes.take<double>(), bytes.take<double>(), bytes.take<double>()};
      status = odomcalib_odometry_set_pose(odometry, pose.data());
      break;
    }
    case 5:
      look_at_beam(odometry, bytes);
      return;
    case 6:
      look_at_path(odometry, bytes);
      return;
    default: {
      const auto left = bytes.take<std::int16_t>(), right = bytes.take<std::int16_t>();
      status = odomcalib_odometry_update_counts(odometry, stamp, left, right);
      break;
    }
  }
  require((status == ODOMCALIB_OK) == (std::strlen(odomcalib_odometry_problem(odometry)) == 0));
  if (status != ODOMCALIB_OK) require(pose_of(odometry) == before);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  odomcalib_options options = ODOMCALIB_OPTIONS_INIT;
  options.counter_bits = bytes.take<std::uint8_t>();
  options.use_refused = 1;
  const std::string text = bytes.take_text();
  std::array<char, 64> problem{};
  odomcalib_odometry* odometry = nullptr;
  const int status = odomcalib_odometry_open_text(text.data(), text.size(), &options, &odometry,
                                                  problem.data(), problem.size());
  require((status == ODOMCALIB_OK) == (odometry != nullptr) && problem.back() == '\0');
  if (odometry == nullptr) return 0;
  double stamp = 0.0;
  while (!bytes.empty()) call(odometry, bytes, stamp);
  ask(odometry);
  odomcalib_odometry_close(odometry);
  return 0;
}
