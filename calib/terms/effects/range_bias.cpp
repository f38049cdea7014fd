#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Every range is off by the same length: the zero of the echo's time, a window in front of the sensor, the
// colour of the targets. Flat walls look bent by d (cos(incidence) - 1), and lengths come out wrong by an
// amount that changes with the size of the room.
class RangeBias final : public LidarEffect {
 public:
  [[nodiscard]] std::string name() const override { return "range_bias"; }
  [[nodiscard]] bool is_judged_in_map() const override { return true; }
  [[nodiscard]] std::string covariate() const override { return "range"; }
  [[nodiscard]] std::vector<LidarParameter> parameters() const override {
    return {{"offset", "m", 0.008, 0.2}};
  }
  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& /*sighting*/) const override {
    return {{1.0, 0.0}};
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"range_scale"}; }
};

}  // namespace

LidarEffectPtr make_range_bias() { return std::make_shared<RangeBias>(); }

}  // namespace odomcalib::calib::terms
