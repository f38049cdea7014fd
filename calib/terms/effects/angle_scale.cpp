#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Beams are spread wider or narrower than stated: an increment made from n beams instead of n - 1 steps, a
// nominal field of view. Where the stated steps add up to one turn, as those of a head that goes all the way
// round should, only plain evidence counts, and a periodic error of the angles, as of a disc that is off
// centre, comes first.
class AngleScale final : public LidarEffect {
 public:
  explicit AngleScale(bool all_round) : LidarEffect(row(all_round)) {}

  static LidarEffectRow row(bool all_round) {
    return {
        .name = "angle_scale",
        .bends_walls = true,
        // Few pairs of scans, those of wide views, show what it does: most readings stay nearly where
        // they were.
        .may_leave = all_round ? 0.85 : 0.998,
        .least_z = all_round ? 5.0 : 1.5,
        .share_of_free_term = all_round ? 1.0 : LidarEffectRow{}.share_of_free_term,
        .covariate = "bearing",
        .parameters = {{.name = "epsilon",
                        .unit = "1",
                        .negligible = 5e-4,
                        .largest = 0.1,
                        .meaning = {.factor = 100.0,
                                    .unit = "%",
                                    .is = "share by which the angles between beams are larger than true",
                                    .said = "angles between beams of the lidar are {} too [large|small]"}}},
        .aliases = {"track_width"}};
  }

  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& sighting) const override {
    return {{0.0, sighting.bearing}};
  }
};

}  // namespace

LidarEffectPtr make_angle_scale(bool all_round) { return std::make_shared<AngleScale>(all_round); }

}  // namespace odomcalib::calib::terms
