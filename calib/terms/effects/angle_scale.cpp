#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {
namespace {

// Beams are spread wider or narrower than stated: an increment made from n beams instead of n - 1 steps, a
// nominal field of view. Where the stated steps add up to one turn, as those of a head that goes all the way
// round should, only plain evidence counts, and a periodic error of the angles, as of a disc that is off
// centre, comes first.
class AngleScale final : public LidarEffect {
 public:
  explicit AngleScale(bool all_round) : all_round_(all_round) {}
  [[nodiscard]] std::string name() const override { return "angle_scale"; }
  [[nodiscard]] std::string covariate() const override { return "bearing"; }
  [[nodiscard]] std::vector<LidarParameter> parameters() const override {
    return {{"epsilon", "1", 5e-4, 0.1}};
  }
  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& sighting) const override {
    return {{0.0, sighting.bearing}};
  }
  /// Few pairs of scans, those of wide views, show what it does: most readings stay nearly where they were.
  [[nodiscard]] double may_leave() const override { return all_round_ ? 0.85 : 0.998; }
  [[nodiscard]] double least_z() const override { return all_round_ ? 5.0 : 1.5; }
  [[nodiscard]] double share_of_free_term() const override {
    return all_round_ ? 1.0 : LidarEffect::share_of_free_term();
  }
  [[nodiscard]] std::vector<std::string> aliases() const override { return {"track_width"}; }

 private:
  bool all_round_;
};

}  // namespace

LidarEffectPtr make_angle_scale(bool all_round) { return std::make_shared<AngleScale>(all_round); }

}  // namespace odomcalib::calib::terms
