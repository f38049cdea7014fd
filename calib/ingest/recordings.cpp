#include "calib/ingest/recordings.hpp"

#include <algorithm>
#include <utility>

#include "calib/ingest/tick_stamps.hpp"

namespace odomcalib::calib::ingest {

Recordings::Recordings(std::vector<Recording> repaired, const StampReport& stamps)
    : owner_(std::make_shared<const std::vector<Recording>>(std::move(repaired))),
      view_(*owner_),
      stamps_(stamps) {}

bool Recordings::are_those_of(const Recordings& other) const {
  return view_.data() == other.view_.data() && view_.size() == other.view_.size();
}

Recordings Recordings::reported_as(const StampReport& stamps) const {
  Recordings same = *this;
  same.stamps_ = stamps;
  return same;
}

Recording& Repairs::own(std::size_t k) {
  if (own_.empty()) own_.assign(given_.begin(), given_.end());
  return own_[k];
}

Recordings Repairs::take(const StampReport& stamps) && {
  return any() ? Recordings(std::move(own_), stamps) : Recordings(given_);
}

Recordings with_even_ticks(std::span<const Recording> given) {
  Repairs repairs(given);
  StampReport stamps;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const auto even = even_ticks(given[i])) {
      set_stamps(repairs.own(i).ticks, even->t);
      stamps.ticks = std::max(stamps.ticks, even->jitter);
    }
  return std::move(repairs).take(stamps);
}

}  // namespace odomcalib::calib::ingest
