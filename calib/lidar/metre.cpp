#include "calib/lidar/metre.hpp"

#include <cmath>
#include <cstddef>

namespace odomcalib::calib {
namespace {

constexpr std::size_t kScans = 50;  ///< of a recording, evenly

double slope(const LidarFinding& finding, double bearing, double range) {
  constexpr double kHalfStep = 0.05;  // of the range
  const auto error = [&](double r) { return finding.effect->total({bearing, r}, finding.values).radial; };
  const double step = kHalfStep * range;
  return (error(range + step) - error(range - step)) / (2.0 * step);
}

class MeanSquare {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  [[nodiscard]] double root() const {
    return count_ == 0 ? 0.0 : std::sqrt(sum_ / static_cast<double>(count_));
  }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

}  // namespace

double metre_in_doubt(const std::vector<LidarFinding>& findings, std::span<const Recording> recordings) {
  MeanSquare slopes;
  for (const Recording& recording : recordings)
    for (std::size_t s = 0; s < recording.scans.size(); s += 1 + recording.scans.size() / kScans) {
      const Scan& scan = recording.scans[s];
      for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
        const auto range = static_cast<double>(scan.ranges[k]);
        if (!(range > 0.0)) continue;
        double all = 0.0;
        for (const LidarFinding& finding : findings)
          if (!finding.effect->is_correctable()) all += slope(finding, scan.angle(k), range);
        slopes.add(all);
      }
    }
  return 0.5 * slopes.root();
}

}  // namespace odomcalib::calib
