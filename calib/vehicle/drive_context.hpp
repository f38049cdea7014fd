// All intervals of a drive as the model and the effects see them.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "calib/vehicle/covariates.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::vehicle {

/// Covariates on demand of all intervals of a drive: of each kind those of the whole drive are made when the
/// first is asked for, since they hang on what was before. Not to be shared between threads.
class DriveOnDemand final : public OnDemand {
 public:
  /// @param dither rad, within which a wheel that stands may show either of two counts
  DriveOnDemand(const std::vector<StepContext>& intervals, const wheels::BaseParameters& base, double dither,
                CovariateGroups groups);
  /// All zero where the group is none of those asked for.
  [[nodiscard]] const LostByWheels& lost_to_play(std::size_t interval) const override;
  [[nodiscard]] const CasterSines& caster(std::size_t interval) const override;
  /// Gives their memory back until they are asked for again.
  void forget() const;

 private:
  struct Rotation {
    double left, right;  ///< rad
  };
  std::vector<Rotation> rotations_;
  wheels::BaseParameters base_;
  double dither_;
  CovariateGroups groups_;
  mutable std::vector<LostByWheels> lost_;
  mutable std::vector<CasterSines> casters_;
};

/// Contexts of all intervals, one after the other, with what they refer to. A copy shares that.
class DriveContext {
 public:
  DriveContext() = default;
  DriveContext(std::vector<StepContext> intervals, std::shared_ptr<const DriveOnDemand> on_demand);

  [[nodiscard]] const std::vector<StepContext>& intervals() const { return intervals_; }
  [[nodiscard]] std::size_t size() const { return intervals_.size(); }
  [[nodiscard]] auto begin() { return intervals_.begin(); }
  [[nodiscard]] auto end() { return intervals_.end(); }
  [[nodiscard]] auto begin() const { return intervals_.begin(); }
  [[nodiscard]] auto end() const { return intervals_.end(); }
  [[nodiscard]] StepContext& operator[](std::size_t k) { return intervals_[k]; }
  [[nodiscard]] const StepContext& operator[](std::size_t k) const { return intervals_[k]; }
  [[nodiscard]] const StepContext& front() const { return intervals_.front(); }
  [[nodiscard]] const StepContext& back() const { return intervals_.back(); }
  void forget_on_demand() const {
    if (on_demand_) on_demand_->forget();
  }

 private:
  std::vector<StepContext> intervals_;
  std::shared_ptr<const DriveOnDemand> on_demand_;
};

}  // namespace odomcalib::calib::vehicle
