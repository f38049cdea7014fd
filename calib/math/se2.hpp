// Rigid motions of the plane, templated on the scalar so that derivatives can be automatic.
// Conventions: REP-103 (x forward, y left, yaw counter-clockwise); T_a_b maps coordinates in b to coordinates
// in a.
#pragma once

#include <cmath>
#include <numbers>

namespace odomcalib::calib::math {

inline constexpr double kPi = std::numbers::pi;

/// Angle in (-pi, pi].
template <typename T>
T wrap_angle(const T& angle) {
  using std::ceil;
  const T turns = ceil((angle - kPi) / (2.0 * kPi));
  return angle - 2.0 * kPi * turns;
}

/// Angle in [0, 2 pi).
inline double angle_of_turn(double angle) { return angle - 2.0 * kPi * std::floor(angle / (2.0 * kPi)); }

/// A pose or a motion: x, y [m], yaw [rad]. Yaw is kept unwrapped so that multi-turn motions stay readable.
template <typename T>
struct Pose2 {
  T x{0.0};
  T y{0.0};
  T yaw{0.0};
};
using Pose = Pose2<double>;

/// T_a_c from T_a_b and T_b_c (Censi et al. 2013, eq. 3).
template <typename T>
Pose2<T> compose(const Pose2<T>& a, const Pose2<T>& b) {
  using std::cos;
  using std::sin;
  const T c = cos(a.yaw);
  const T s = sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, a.yaw + b.yaw};
}

template <typename T>
Pose2<T> inverse(const Pose2<T>& a) {
  using std::cos;
  using std::sin;
  const T c = cos(a.yaw);
  const T s = sin(a.yaw);
  return {-c * a.x - s * a.y, s * a.x - c * a.y, -a.yaw};
}

/// Motion from a to b in the frame of a: inverse(a) * b.
template <typename T>
Pose2<T> between(const Pose2<T>& a, const Pose2<T>& b) {
  using std::cos;
  using std::sin;
  const T c = cos(a.yaw);
  const T s = sin(a.yaw);
  const T dx = b.x - a.x;
  const T dy = b.y - a.y;
  return {c * dx + s * dy, -s * dx + c * dy, b.yaw - a.yaw};
}

/// Motion of a sensor mounted at `mount` on a base that moves by `motion`: mount^-1 * motion * mount.
template <typename T>
Pose2<T> conjugate(const Pose2<T>& motion, const Pose2<T>& mount) {
  return between(mount, compose(motion, mount));
}

/// sin(a) / a and (1 - cos(a)) / a.
template <typename T>
struct ArcRatios {
  T sine{1.0};
  T cosine{0.0};
  explicit ArcRatios(const T& a) {
    using std::abs;
    using std::cos;
    using std::sin;
    if (abs(a) > T(0.05)) {
      sine = sin(a) / a;
      cosine = (1.0 - cos(a)) / a;
    } else {  // Taylor, good to 1e-16 at the threshold; the ratio of cosines would lose digits
      const T square = a * a;
      sine = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0));
      cosine = a / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    }
  }
};

/// Group exponential: constant twist (dx, dy, dyaw) over unit time. Exact arc for dy = 0.
template <typename T>
Pose2<T> exp_se2(const T& dx, const T& dy, const T& dyaw) {
  const ArcRatios<T> ratio(dyaw);
  return {ratio.sine * dx - ratio.cosine * dy, ratio.cosine * dx + ratio.sine * dy, dyaw};
}

/// Inverse of exp_se2 for |yaw| < pi.
template <typename T>
Pose2<T> log_se2(const Pose2<T>& a) {
  using std::abs;
  using std::tan;
  const T half = a.yaw / 2.0;
  T factor{1.0};
  if (abs(half) > T(1e-6))
    factor = half / tan(half);
  else
    factor = 1.0 - half * half / 3.0;
  return {factor * a.x + half * a.y, -half * a.x + factor * a.y, a.yaw};
}

}  // namespace odomcalib::calib::math
