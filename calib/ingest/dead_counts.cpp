#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "calib/ingest/form.hpp"
#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"

namespace odomcalib::calib::ingest {
namespace {

struct Wheel {
  std::int64_t TickSample::*own;
  std::int64_t TickSample::*other;
  const char* reason;
};

constexpr Wheel kWheels[] = {
    {&TickSample::left, &TickSample::right, "the left count stands still while the right wheel rolls"},
    {&TickSample::right, &TickSample::left, "the right count stands still while the left wheel rolls"}};

/// Counts that a wheel rolls while the robot turns so often about the other one; 0 where nobody can say.
double longest_pivot(const RobotDescription& robot) {
  const double diameter = std::max(robot.left_wheel_diameter, robot.right_wheel_diameter);
  if (!(diameter > 0.0) || !(robot.track_width > 0.0)) return 0.0;
  return settings::kMostPivots * 2.0 * robot.track_width / diameter * robot.ticks_per_rev;
}

/// Marks what follows the first sample of each stretch in which one count stands still for so long.
std::vector<bool> dead_counts(const std::vector<TickSample>& ticks, const Wheel& wheel, double most) {
  std::vector<bool> dead(ticks.size(), false);
  for (std::size_t begin = 0; begin < ticks.size();) {
    double rolled = 0.0;
    std::size_t end = begin + 1;
    for (; end < ticks.size() && ticks[end].*wheel.own == ticks[begin].*wheel.own &&
           ticks[end].segment == ticks[begin].segment;
         ++end)
      rolled += static_cast<double>(std::abs(ticks[end].*wheel.other - ticks[end - 1].*wheel.other));
    const bool is_all = begin == 0 && end == ticks.size();
    if (rolled > most && !is_all)
      std::fill(dead.begin() + static_cast<std::ptrdiff_t>(begin) + 1,
                dead.begin() + static_cast<std::ptrdiff_t>(end), true);
    begin = end;
  }
  return dead;
}

}  // namespace

std::optional<Recording> without_dead_counts(const Recording& recording) {
  const double most = longest_pivot(recording.robot);
  if (!(most > 0.0)) return std::nullopt;
  std::optional<Recording> mended;
  for (const Wheel& wheel : kWheels) {
    const Recording& given = mended ? *mended : recording;
    const Discarded lost{name_of(motion_of(given)), wheel.reason};
    if (auto next = without_marked(given, &Recording::ticks, lost, dead_counts(given.ticks, wheel, most)))
      mended = std::move(next);
  }
  return mended;
}

}  // namespace odomcalib::calib::ingest
