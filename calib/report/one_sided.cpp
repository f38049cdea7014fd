#include "calib/report/one_sided.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "calib/ingest/form.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/report/settings.hpp"
#include "calib/wheels/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// Whether samples lie around an instant, none farther than an interruption from the next.
bool is_within(const std::vector<double>& times, double t) {
  const auto after = std::lower_bound(times.begin(), times.end(), t);
  if (after == times.end() || (after == times.begin() && *after > t)) return false;
  return *after == t || *after - *std::prev(after) <= ingest::settings::kMaxGap_s;
}

/// Whether both wheels have the same counts on either side of an instant.
bool stands(const std::vector<TickSample>& ticks, double t) {
  const auto after = std::lower_bound(ticks.begin(), ticks.end(), t,
                                      [](const TickSample& tick, double time) { return tick.t < time; });
  if (after == ticks.begin() || after == ticks.end()) return true;
  const TickSample& before = *std::prev(after);
  return std::max(std::abs(after->left - before.left), std::abs(after->right - before.right)) <=
         wheels::settings::kStandingCounts;
}

std::vector<Discarded> where_many(Discarded one, double share) {
  return share > settings::kOneSided ? std::vector<Discarded>{std::move(one)} : std::vector<Discarded>{};
}

std::vector<Discarded> without_counts(const Recording& recording, const std::vector<double>& reference) {
  const std::vector<double> counts = stamps_of(recording.ticks);
  Discarded one{.what = name_of(ingest::reference_of(recording)),
                .reason = "no counts at that time",
                .of = reference.size()};
  for (const double t : reference) {
    const bool outside = t < counts.front() || t > counts.back();
    if (outside || (!is_within(counts, t) && !stands(recording.ticks, t))) count_one(one, t);
  }
  return where_many(one, static_cast<double>(one.count) / static_cast<double>(one.of));
}

std::vector<Discarded> without_reference(const Recording& recording, const std::vector<double>& reference) {
  const std::vector<TickSample>& ticks = recording.ticks;
  Discarded one{.what = "counts",
                .reason = ingest::reference_of(recording) == ingest::Form::pose ? "no poses at that time"
                                                                                : "no scans at that time",
                .of = ticks.size()};
  double turned = 0.0, unseen = 0.0;  // counts of both wheels
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    if (ticks[k].segment != ticks[k - 1].segment) continue;
    const auto way = static_cast<double>(std::abs(ticks[k].left - ticks[k - 1].left) +
                                         std::abs(ticks[k].right - ticks[k - 1].right));
    turned += way;
    if (is_within(reference, ticks[k].t)) continue;
    unseen += way;
    count_one(one, ticks[k].t);
  }
  return where_many(one, turned > 0.0 ? unseen / turned : 0.0);
}

}  // namespace

std::vector<Discarded> one_sided(const Recording& recording) {
  const std::vector<double> reference = ingest::stamps_of(recording, ingest::reference_of(recording));
  if (recording.ticks.size() < 2 || reference.size() < 2) return {};
  std::vector<Discarded> all = without_counts(recording, reference);
  const std::vector<Discarded> more = without_reference(recording, reference);
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace odomcalib::calib::report
