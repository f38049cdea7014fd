#include "calib/library/sample_gate.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::calib::library {

bool SampleGate::follows(const TickSample& from, const TickSample& to) const {
  if (!(to.t > from.t)) return false;
  const double interval = std::max(to.t - from.t, usual_interval_);
  const double most = settings::kFastest * interval + metres_per_count_;
  const auto way = [&](std::int64_t before, std::int64_t now) {
    return metres_per_count_ * std::abs(static_cast<double>(now - before));
  };
  return way(from.left, to.left) <= most && way(from.right, to.right) <= most;
}

void SampleGate::take(const TickSample& sample) {
  last_ = sample;
  rejected_.reset();
}

Admission SampleGate::admit(const TickSample& sample) {
  if (!last_) {
    take(sample);
    return Admission::goes_on;
  }
  if (follows(*last_, sample)) {
    const double interval = std::min(sample.t - last_->t, settings::kLongestInterval_s);
    usual_interval_ += settings::kShareOfInterval * (interval - usual_interval_);
    take(sample);
    return Admission::goes_on;
  }
  if (rejected_ && follows(*rejected_, sample)) {
    begin_ = *rejected_;
    take(sample);
    return Admission::anew;
  }
  rejected_ = sample;
  return sample.t > last_->t ? Admission::jump : Admission::not_later;
}

void SampleGate::restart() {
  last_.reset();
  rejected_.reset();
}

}  // namespace odomcalib::calib::library
