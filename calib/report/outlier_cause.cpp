#include "calib/report/outlier_cause.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/math/vector2.hpp"
#include "calib/report/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// A mean that is reported only where chance does not make it.
class PlainMean {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
    count_ += 1.0;
  }
  [[nodiscard]] double value() const {
    if (count_ < settings::kFewestOfCause) return 0.0;
    const double mean = sum_ / count_;
    const double variance = (squares_ / count_ - mean * mean) / (count_ - 1.0);
    return mean * mean > settings::kClearCause * settings::kClearCause * variance ? mean : 0.0;
  }

 private:
  double sum_ = 0.0, squares_ = 0.0, count_ = 0.0;
};

/// In the matcher's deviations, squared.
double length(const Eigen::Vector3d& error, const measurement::SensorPair& pair) {
  return error.cwiseAbs2().cwiseQuotient(pair.covariance.diagonal()).sum();
}

class Causes {
 public:
  /// @param error of the wheels: matched less predicted, in the sensor's frame
  void add(const measurement::FitData& data, const measurement::SensorPair& pair,
           const Eigen::Vector3d& error, const measurement::PathOfWheels& wheels) {
    const auto ends = places_at_ends(data.places, pair.interval, wheels);
    if (!ends) return;
    ++cause_.placed;
    const math::Pose placed = between(ends->begin.pose, ends->end.pose);
    if (length(math::difference(pair.motion, placed), pair) > settings::kNearPlaces * length(error, pair))
      return;
    ++cause_.confirmed;
    add_excess({pair.motion.x - error(0), pair.motion.y - error(1), pair.motion.yaw - error(2)}, error);
  }

  [[nodiscard]] OutlierCause result() const {
    OutlierCause all = cause_;
    all.farther = way_.value();
    all.turned_farther = turn_.value();
    return all;
  }

 private:
  /// Along a motion that is one; at rest there is no way to go.
  void add_excess(const math::Pose& predicted, const Eigen::Vector3d& error) {
    const double way = std::hypot(predicted.x, predicted.y);
    if (way > settings::kAtRest) way_.add((error(0) * predicted.x + error(1) * predicted.y) / way);
    if (std::abs(predicted.yaw) > settings::kAtRest) turn_.add(std::copysign(1.0, predicted.yaw) * error(2));
  }

  OutlierCause cause_;
  PlainMean way_, turn_;
};

}  // namespace

OutlierCause cause_of_outliers(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                               const estimation::FitResult& fit) {
  Causes causes;
  std::size_t k = 0;
  for (const measurement::FitData& d : data) {
    const vehicle::Trajectory trajectory = d.model->trajectory(vehicle::as_span(fit.parameters), effects);
    const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
    for (const measurement::SensorPair& pair : d.pairs) {
      if (fit.outlier[k])
        causes.add(d, pair, fit.residuals.row(static_cast<Eigen::Index>(k)).transpose(), wheels);
      ++k;
    }
  }
  return causes.result();
}

}  // namespace odomcalib::calib::report
