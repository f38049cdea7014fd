#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/ingest/scan_faults.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

bool is_the_same(const Scan& a, const Scan& b) {
  if (a.ranges != b.ranges || a.angle_min != b.angle_min) return false;
  const auto readings = std::count_if(a.ranges.begin(), a.ranges.end(), [](float r) { return r > 0.0F; });
  return readings >= settings::kReadingsOfScan;
}

/// m at the rim, of the wheel that turned more.
class WheelWay {
 public:
  explicit WheelWay(const Recording& recording) : ticks_(recording.ticks) {
    const RobotDescription& robot = recording.robot;
    if (robot.ticks_per_rev > 0.0)
      metres_ =
          math::kPi * std::max(robot.left_wheel_diameter, robot.right_wheel_diameter) / robot.ticks_per_rev;
  }

  /// Asked in order of time.
  [[nodiscard]] double between(double begin, double end) {
    const TickSample *from = at(begin), *to = at(end);
    if (from == nullptr || to == nullptr || from->segment != to->segment) return 0.0;
    const auto way = std::max(std::abs(to->left - from->left), std::abs(to->right - from->right));
    return metres_ * static_cast<double>(way);
  }

 private:
  [[nodiscard]] const TickSample* at(double t) const {
    const auto next = std::upper_bound(ticks_.begin(), ticks_.end(), t,
                                       [](double time, const TickSample& tick) { return time < tick.t; });
    return next == ticks_.begin() ? nullptr : &*std::prev(next);
  }

  const std::vector<TickSample>& ticks_;
  double metres_ = 0.0;
};

std::vector<bool> repeats_of(const std::vector<Scan>& scans) {
  std::vector<bool> repeats(scans.size(), false);
  for (std::size_t k = 1; k < scans.size(); ++k) repeats[k] = is_the_same(scans[k - 1], scans[k]);
  return repeats;
}

/// At rest a lidar without noise sends equal scans as well.
bool repeats_in_motion(const Recording& recording, const std::vector<bool>& repeats) {
  WheelWay way(recording);
  for (std::size_t k = 1; k < repeats.size(); ++k)
    if (repeats[k] && way.between(recording.scans[k - 1].t, recording.scans[k].t) > settings::kMovedBetween_m)
      return true;
  return false;
}

}  // namespace

std::optional<Recording> without_repeated_scans(const Recording& recording) {
  const std::vector<bool> repeats = repeats_of(recording.scans);
  if (!repeats_in_motion(recording, repeats)) return std::nullopt;
  Recording once = recording;
  once.scans.clear();
  Discarded dropped{"scan", kRepeatedScan, 0, recording.scans.size()};
  for (std::size_t k = 0; k < repeats.size(); ++k) {
    const Scan& scan = recording.scans[k];
    if (!repeats[k]) {
      once.scans.push_back(scan);
      continue;
    }
    ++dropped.count;
    if (!dropped.begin) dropped.begin = scan.t;
    dropped.end = scan.t;
  }
  once.discarded.push_back(dropped);
  return once;
}

}  // namespace odomcalib::calib::ingest
