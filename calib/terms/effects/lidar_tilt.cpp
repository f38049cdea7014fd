#include <cmath>

#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// A scan plane tilted by a about a horizontal axis meets vertical walls late: r / cos(a cos(bearing - b))
// with b the direction of the steepest beam. To first order in a^2 that is a common stretch a^2/4, which no
// scan shows, and a^2/4 cos 2(bearing - b): the two parameters are its cosine and sine parts.
class LidarTilt final : public LidarEffect {
 public:
  LidarTilt() : LidarEffect(row()) {}

  static LidarEffectRow row() {
    constexpr double kNegligible = 2.5e-4;  // 1.8 degrees
    return {
        .name = "lidar_tilt",
        .covariate = "bearing",
        .parameters = {
            {.name = "stretch_cos",
             .unit = "1",
             .negligible = kNegligible,
             .largest = 0.02,
             .meaning =
                 {.label = "ahead and behind",
                  .factor = 100.0,
                  .unit = "%",
                  .is =
                      "share by which ranges ahead and behind are too long, and those at the sides too short",
                  .said = "ranges of the lidar are {} too [long|short] ahead and behind"}},
            {.name = "stretch_sin",
             .unit = "1",
             .negligible = kNegligible,
             .largest = 0.02,
             .meaning = {
                 .label = "across",
                 .factor = 100.0,
                 .unit = "%",
                 .is = "share by which ranges ahead left and behind right are too long, and the others too "
                       "short",
                 .said = "ranges of the lidar are {} too [long|short] ahead left and behind right"}}}};
  }

  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& s) const override {
    return {{s.range * std::cos(2.0 * s.bearing), 0.0}, {s.range * std::sin(2.0 * s.bearing), 0.0}};
  }
  [[nodiscard]] BeamShift total(const Sighting& s, std::span<const double> values) const override {
    const Tilt tilt = tilt_of(values);
    return {s.range * (1.0 - std::cos(tilt.angle * std::cos(s.bearing - tilt.direction))), 0.0};
  }
  [[nodiscard]] std::vector<std::pair<std::string, Quantity>> quantities(
      std::span<const double> values, std::span<const double> deviations) const override {
    const Tilt tilt = tilt_of(values);
    const double stretch = std::hypot(values[0], values[1]);
    const double deviation =
        std::hypot(values[0] * deviations[0], values[1] * deviations[1]) / std::max(stretch, 1e-12);
    return {{"angle", {tilt.angle, 2.0 * deviation / std::max(tilt.angle, 1e-6), "rad"}},
            {"direction", {tilt.direction, deviation / std::max(2.0 * stretch, 1e-12), "rad"}}};
  }

  [[nodiscard]] std::vector<double> values_of(const QuantityList& stated) const override {
    if (stated.size() != parameters().size()) return {};
    const double angle = stated[0].second.value, direction = stated[1].second.value;
    const double stretch = 0.25 * angle * angle;
    return {stretch * std::cos(2.0 * direction), stretch * std::sin(2.0 * direction)};
  }

 private:
  struct Tilt {
    double angle = 0.0;      // rad
    double direction = 0.0;  // rad, of the steepest beam, to a half turn
  };
  static Tilt tilt_of(std::span<const double> values) {
    return {2.0 * std::sqrt(std::hypot(values[0], values[1])), 0.5 * std::atan2(values[1], values[0])};
  }
};

}  // namespace

LidarEffectPtr make_lidar_tilt() { return std::make_shared<LidarTilt>(); }

}  // namespace odomcalib::calib::terms
