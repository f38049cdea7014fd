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

Recordings with_even_ticks(std::span<const Recording> given) {
  std::vector<Recording> repaired;  // a copy of all, made when the first of them is changed
  StampReport stamps;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (const auto even = even_ticks(given[i])) {
      if (repaired.empty()) repaired.assign(given.begin(), given.end());
      set_stamps(repaired[i].ticks, even->t);
      stamps.ticks = std::max(stamps.ticks, even->jitter);
    }
  return repaired.empty() ? Recordings(given) : Recordings(std::move(repaired), stamps);
}

}  // namespace odomcalib::calib::ingest
