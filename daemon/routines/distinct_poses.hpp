// Poses along a way, each once.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <utility>
#include <vector>

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

class DistinctPoses {
 public:
  /// @param place m and @param heading rad, of poses that are one
  DistinctPoses(double place, double heading) : place_(place), heading_(heading) {}

  void add(const Pose& pose);
  std::vector<Pose> take() && { return std::move(poses_); }

 private:
  [[nodiscard]] std::uint64_t cell_of(const Pose& pose) const;

  double place_, heading_;
  std::unordered_set<std::uint64_t> taken_;
  std::uint64_t last_ = 0;
  std::vector<Pose> poses_;
};

}  // namespace odomcalib::routines
