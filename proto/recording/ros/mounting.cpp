#include "proto/recording/ros/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace odomcalib::ros {
namespace {

// Cosine of the tilt up to which a lidar is level. Chosen: 15 degrees; what leans more does not scan the
// plane that the robot drives in.
constexpr double kLevel = 0.966;

/// Rotation, row by row, and position.
struct Placed {
  std::array<std::array<double, 3>, 3> rotation{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  std::array<double, 3> position{};
};

Placed placed(const Transform& transform) {
  const auto& [x, y, z, w] = transform.quaternion;
  const double n = x * x + y * y + z * z + w * w;
  const double s = 2.0 / n;
  return {{{{1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
            {s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)},
            {s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)}}},
          transform.position};
}

/// `b`, given in the frame of `a`, in the frame that `a` is given in.
Placed composed(const Placed& a, const Placed& b) {
  Placed out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position[i] = a.position[i];
    for (std::size_t k = 0; k < 3; ++k) {
      out.position[i] += a.rotation[i][k] * b.position[k];
      out.rotation[i][k] = 0.0;
      for (std::size_t j = 0; j < 3; ++j) out.rotation[i][k] += a.rotation[i][j] * b.rotation[j][k];
    }
  }
  return out;
}

Placed inverse(const Placed& a) {
  Placed out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position[i] = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      out.rotation[i][k] = a.rotation[k][i];
      out.position[i] -= a.rotation[k][i] * a.position[k];
    }
  }
  return out;
}

/// The frame and all that it hangs on, each with its place in that one: of the frame itself first. A ring of
/// transforms ends where it began.
std::vector<std::pair<std::string, Placed>> ancestors(const std::map<std::string, const Transform*>& parents,
                                                      std::string frame) {
  std::vector<std::pair<std::string, Placed>> chain{{frame, {}}};
  while (chain.size() <= parents.size()) {
    const auto parent = parents.find(frame);
    if (parent == parents.end()) break;
    frame = parent->second->frame;
    chain.emplace_back(frame, composed(placed(*parent->second), chain.back().second));
  }
  return chain;
}

}  // namespace

std::optional<Mounting> mounting_of(const std::vector<Transform>& transforms,
                                    const std::vector<std::string>& bases, const std::string& lidar) {
  std::map<std::string, const Transform*> parents;
  for (const Transform& one : transforms) parents[one.child] = &one;
  const auto of_lidar = ancestors(parents, lidar);
  for (const std::string& base : bases)
    for (const auto& above : ancestors(parents, base)) {
      const auto common = std::find_if(of_lidar.begin(), of_lidar.end(),
                                       [&](const auto& one) { return one.first == above.first; });
      if (common == of_lidar.end()) continue;
      const Placed mount = composed(inverse(above.second), common->second);
      const std::array<double, 3> pose{mount.position[0], mount.position[1],
                                       std::atan2(mount.rotation[1][0], mount.rotation[0][0])};
      if (!std::all_of(pose.begin(), pose.end(), [](double one) { return std::isfinite(one); }))
        return std::nullopt;
      return Mounting{base, pose, mount.rotation[2][2] > kLevel};
    }
  return std::nullopt;
}

}  // namespace odomcalib::ros
