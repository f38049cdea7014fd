#include "calib/lidar/lidar_effect.hpp"

namespace odomcalib::calib {
namespace {

// Beams are spread wider or narrower than stated: an increment made from n beams instead of n - 1 steps, a
// nominal field of view. A head that goes all the way round has none if its stated steps add up to one turn.
class AngleScale final : public LidarEffect {
 public:
  [[nodiscard]] std::string name() const override { return "angle_scale"; }
  [[nodiscard]] std::string variable() const override { return "bearing"; }
  [[nodiscard]] std::vector<LidarParameter> parameters() const override {
    return {{"epsilon", "1", 5e-4, 0.1}};
  }
  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& sighting) const override {
    return {{0.0, sighting.bearing}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"track_width"}; }
};

}  // namespace

LidarEffectPtr make_angle_scale() { return std::make_shared<AngleScale>(); }

}  // namespace odomcalib::calib
