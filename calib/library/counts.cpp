#include "calib/library/counts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/library/settings.hpp"
#include "proto/recording/wheel_motion.hpp"

namespace odomcalib::calib::library {
namespace {

/// The difference of two counters that wrap, to either side the smaller one.
std::int64_t wrapped(std::int64_t now, std::int64_t before, int bits) {
  const std::uint64_t turn = std::uint64_t{1} << bits;
  const std::uint64_t ahead =
      (static_cast<std::uint64_t>(now) - static_cast<std::uint64_t>(before)) & (turn - 1);
  const auto difference = static_cast<std::int64_t>(ahead);
  return ahead >= turn / 2 ? difference - static_cast<std::int64_t>(turn) : difference;
}

std::optional<std::int64_t> counted(double angle, double counts_per_turn) {
  const double counts = angle / (2.0 * std::numbers::pi) * counts_per_turn;
  if (!(std::abs(counts) < static_cast<double>(settings::kMostCounts))) return std::nullopt;
  return count_of(angle, counts_per_turn);
}

}  // namespace

Counts CounterWrap::operator()(const Counts& raw) {
  if (bits_ == 0) return raw;
  if (!last_raw_) total_ = raw;
  for (std::size_t k = 0; k < raw.size(); ++k)
    if (last_raw_) total_.at(k) += wrapped(raw.at(k), last_raw_->at(k), bits_);
  last_raw_ = raw;
  return total_;
}

std::optional<Counts> AngleCounts::operator()(const std::array<double, 2>& angles) {
  if (!first_) first_ = angles;
  Counts counts{};
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const auto begin = counted(first_->at(k), counts_per_turn_);
    const auto since = counted(angles.at(k) - first_->at(k), counts_per_turn_);
    if (!begin || !since) return std::nullopt;
    counts.at(k) = *begin + *since;
  }
  return counts;
}

std::optional<Counts> SpeedCounts::at(double stamp, const std::array<double, 2>& speeds) {
  next_ = Held{stamp, speeds, last_ ? last_->angles : std::array<double, 2>{}};
  Counts counts{};
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (last_) next_->angles.at(k) += (stamp - last_->stamp) * last_->speeds.at(k);
    const auto now = counted(next_->angles.at(k), counts_per_turn_);
    if (!now) return std::nullopt;
    counts.at(k) = *now;
  }
  return counts;
}

void SpeedCounts::keep() { last_ = next_; }

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
