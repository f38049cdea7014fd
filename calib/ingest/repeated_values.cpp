#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/ingest/reference_faults.hpp"
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

bool is_the_same(const PoseSample& a, const PoseSample& b) {
  return a.x == b.x && a.y == b.y && a.yaw == b.yaw;
}

template <typename Sample>
std::vector<bool> repeats_of(const std::vector<Sample>& samples) {
  std::vector<bool> repeats(samples.size(), false);
  for (std::size_t k = 1; k < samples.size(); ++k) repeats[k] = is_the_same(samples[k - 1], samples[k]);
  return repeats;
}

/// At rest a lidar without noise repeats itself as well: the wheels have to turn meanwhile, or, where a scan
/// comes again within milliseconds, before and after most of the repeats.
bool repeats_in_motion(const Recording& recording, const std::vector<bool>& repeats) {
  const std::vector<Scan>& scans = recording.scans;
  WheelWay way(recording);
  std::vector<bool> moves(scans.size(), false);  // since the scan before
  for (std::size_t k = 1; k < scans.size(); ++k)
    moves[k] = way.between(scans[k - 1].t, scans[k].t) > settings::kMovedBetween_m;
  std::ptrdiff_t all = 0, on_the_way = 0;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    if (!repeats[k]) continue;
    if (moves[k]) return true;
    ++all;
    if (moves[k - 1] && k + 1 < scans.size() && moves[k + 1]) ++on_the_way;
  }
  return 2 * on_the_way > all;
}

double way_between(const PoseSample& a, const PoseSample& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// A robot that stops slows down before: a value that stays between two steps of motion was sent again. Or
/// one is held, as by a camera that lost its marker. Where all are one value, that is for the checks to say.
std::vector<bool> repeated_poses(const Recording& recording) {
  const std::vector<PoseSample>& poses = recording.poses;
  const std::vector<bool> same = repeats_of(poses);
  std::vector<bool> repeats(poses.size(), false);
  WheelWay way(recording);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (!same[k] || same[k - 1]) continue;
    std::size_t next = k;
    while (next < poses.size() && same[next]) ++next;
    if (k == 1 && next == poses.size()) break;
    const bool is_sent_again =
        k >= 2 && next < poses.size() && next - k <= settings::kMostRepeats &&
        std::min(way_between(poses[k - 2], poses[k - 1]), way_between(poses[next - 1], poses[next])) >=
            settings::kMovedBetween_m;
    if (!is_sent_again && way.between(poses[k - 1].t, poses[next - 1].t) < settings::kRolledWhileHeld_m)
      continue;
    std::fill(repeats.begin() + static_cast<std::ptrdiff_t>(k),
              repeats.begin() + static_cast<std::ptrdiff_t>(next), true);
  }
  return repeats;
}

}  // namespace

std::optional<Recording> without_repeated_scans(const Recording& recording) {
  const std::vector<bool> repeats = repeats_of(recording.scans);
  if (!repeats_in_motion(recording, repeats)) return std::nullopt;
  return without_marked(recording, &Recording::scans, {"scan", kRepeatedValues}, repeats);
}

std::optional<Recording> without_repeated_poses(const Recording& recording) {
  const std::vector<bool> repeats = repeated_poses(recording);
  return without_marked(recording, &Recording::poses, {"pose", kRepeatedValues}, repeats);
}

}  // namespace odomcalib::calib::ingest
