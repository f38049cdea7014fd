#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Every range is off by the same length: the zero of the echo's time, a window in front of the sensor, the
// colour of the targets. Flat walls look bent by d (cos(incidence) - 1), and lengths come out wrong by an
// amount that changes with the size of the room.
class RangeBias final : public LidarEffect {
 public:
  RangeBias() : LidarEffect(row()) {}

  static LidarEffectRow row() {
    return {.name = "range_bias",
            .is_judged_in_map = true,
            .covariate = "range",
            .parameters = {{.name = "offset",
                            .unit = "m",
                            .negligible = 0.008,
                            .largest = 0.2,
                            .meaning = {.factor = 1e3,
                                        .unit = "mm",
                                        .is = "by which every range is too long",
                                        .said = "ranges of the lidar are {} too [long|short]"}}},
            .aliases = {"range_scale"}};
  }

  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& /*sighting*/) const override {
    return {{1.0, 0.0}};
  }
};

}  // namespace

LidarEffectPtr make_range_bias() { return std::make_shared<RangeBias>(); }

}  // namespace odomcalib::calib::terms
