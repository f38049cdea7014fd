#include "daemon/cli/live/trace.hpp"

#include <cmath>

namespace odomcalib::cli {

void Trace::restart(const std::vector<Pose>& points) {
  points_.clear();
  spacing_ = kSpacing;
  now_.reset();
  from_source_.reset();
  for (const Pose& point : points) append(point);
  if (!points.empty()) now_ = points.back();
}

void Trace::continue_from(const Pose& source) {
  from_source_ = calib::math::compose(now_.value_or(Pose{}), calib::math::inverse(source));
}

void Trace::add(const Pose& source) {
  if (!from_source_) continue_from(source);
  now_ = calib::math::compose(*from_source_, source);
  append(*now_);
}

void Trace::append(const Pose& shown) {
  if (!points_.empty() && std::hypot(shown.x - points_.back().x, shown.y - points_.back().y) < spacing_)
    return;
  points_.push_back(shown);
  if (points_.size() < kMostPoints) return;
  spacing_ *= 2.0;
  for (std::size_t k = 1; 2 * k < points_.size(); ++k) points_[k] = points_[2 * k];
  points_.resize((points_.size() + 1) / 2);
}

}  // namespace odomcalib::cli
