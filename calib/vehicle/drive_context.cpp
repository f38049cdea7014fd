#include "calib/vehicle/drive_context.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>

namespace odomcalib::calib::vehicle {

DriveOnDemand::DriveOnDemand(const std::vector<StepContext>& intervals, const wheels::BaseParameters& base,
                             double dither, CovariateGroups groups)
    : base_(base), dither_(dither), groups_(groups) {
  rotations_.reserve(intervals.size());
  for (const StepContext& c : intervals) rotations_.push_back({c.left_delta, c.right_delta});
}

const LostByWheels& DriveOnDemand::lost_to_play(std::size_t interval) const {
  if (!groups_.contain(CovariateGroup::gear_play)) return kNothingLost;
  if (lost_.empty()) {
    GearPlay left, right;
    lost_.reserve(rotations_.size());
    for (const Rotation& r : rotations_)
      lost_.push_back({left.advance(r.left, dither_), right.advance(r.right, dither_)});
  }
  return lost_[interval];
}

const CasterSines& DriveOnDemand::caster(std::size_t interval) const {
  if (!groups_.contain(CovariateGroup::caster)) return kNoSwing;
  if (casters_.empty()) {
    CasterSwing swing;
    casters_.reserve(rotations_.size());
    for (const Rotation& r : rotations_)
      casters_.push_back(swing.advance(
          wheels::wheel_arc(base_.left_radius * r.left, base_.right_radius * r.right, base_.track_width),
          base_.track_width));
  }
  return casters_[interval];
}

void DriveOnDemand::forget() const {
  std::vector<LostByWheels>().swap(lost_);  // clear() would keep the memory
  std::vector<CasterSines>().swap(casters_);
}

DriveContext::DriveContext(std::vector<StepContext> intervals, std::shared_ptr<const DriveOnDemand> on_demand)
    : intervals_(std::move(intervals)), on_demand_(std::move(on_demand)) {
  if (intervals_.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error("a drive of more than 4294967295 intervals");
  for (std::size_t k = 0; k < intervals_.size(); ++k) {
    intervals_[k].interval = static_cast<std::uint32_t>(k);
    intervals_[k].on_demand = on_demand_.get();
  }
}

}  // namespace odomcalib::calib::vehicle
