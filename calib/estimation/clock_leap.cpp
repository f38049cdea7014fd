#include "calib/estimation/clock_leap.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "calib/estimation/explained_rotation.hpp"
#include "calib/estimation/settings.hpp"
#include "calib/ingest/form.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"

namespace odomcalib::calib::estimation {
namespace {

/// A step ahead of one of the two clocks.
struct Leap {
  bool of_counts = false;
  double begin = 0.0;  ///< s, of the last sample before it
  double size = 0.0;   ///< s, by which the stamps after it are too late, if samples come as evenly as before
};

/// Whether a stream has samples in the time after an instant about as often as ever.
bool goes_on(const std::vector<double>& times, double begin, double length, double usual) {
  const auto from = std::upper_bound(times.begin(), times.end(), begin);
  const auto to = std::upper_bound(from, times.end(), begin + length);
  return static_cast<double>(to - from) > settings::kGoesOn * length / usual;
}

std::vector<Leap> gaps_of(const std::vector<double>& times, const std::vector<double>& other,
                          bool of_counts) {
  std::vector<Leap> gaps;
  const double usual = math::median_of(math::differences_of(times));
  const double others = math::median_of(math::differences_of(other));
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double gap = times[k] - times[k - 1];
    if (gap < settings::kLeastLeap_s || gap < settings::kLeapIntervals * usual) continue;
    if (goes_on(other, times[k - 1], std::min(gap, settings::kLongestLook_s), others))
      gaps.push_back({of_counts, times[k - 1], gap - usual});
  }
  return gaps;
}

std::vector<Leap> gaps_of_one_stream(const Recording& recording) {
  const std::vector<double> counts = stamps_of(recording.ticks);
  const std::vector<double> reference = ingest::stamps_of(recording, ingest::reference_of(recording));
  if (counts.size() < 2 || reference.size() < 2) return {};
  std::vector<Leap> gaps = gaps_of(counts, reference, true);
  const std::vector<Leap> more = gaps_of(reference, counts, false);
  gaps.insert(gaps.end(), more.begin(), more.end());
  return gaps.size() > settings::kMostLeaps ? std::vector<Leap>{} : gaps;
}

template <typename Sample>
void put_back(std::vector<Sample>& samples, const Leap& leap) {
  for (Sample& sample : samples)
    if (sample.t > leap.begin) sample.t -= leap.size;
}

/// The stream stays sorted: the gap is longer than what it is put back by.
void put_back(Recording& recording, const Leap& leap) {
  if (leap.of_counts) return put_back(recording.ticks, leap);
  put_back(recording.scans, leap);
  put_back(recording.poses, leap);
}

template <typename Sample>
std::vector<Sample> some_after(const std::vector<Sample>& samples, double begin) {
  const auto from =
      std::find_if(samples.begin(), samples.end(), [&](const Sample& s) { return s.t > begin; });
  const auto count = std::min(samples.end() - from, static_cast<std::ptrdiff_t>(settings::kMostTried));
  return {from, from + count};
}

bool is_a_leap(const Recording& given, const Leap& leap) {
  Recording after;
  after.robot = given.robot;
  after.scans = some_after(given.scans, leap.begin);
  after.poses = some_after(given.poses, leap.begin);
  const auto seen = measurement::reference_motions(after, settings::kMostTried).motions;
  const wheels::WheelTrack track = wheels::wheel_track_from_ticks(given);
  const double as_given = explained_rotation(beside_wheels(seen, track));
  if (!leap.of_counts)
    return mends(as_given, explained_rotation(beside_wheels(seen, track, {leap.size, 0.0, 1.0})));
  Recording mended;
  mended.robot = given.robot;
  mended.ticks = given.ticks;
  put_back(mended, leap);
  return mends(as_given, explained_rotation(beside_wheels(seen, wheels::wheel_track_from_ticks(mended))));
}

Repair repair_of(const Recording& recording, const Leap& leap) {
  const std::string reference = many_of(ingest::reference_of(recording)), counts = "counts";
  return repaired_clock(leap.of_counts ? counts : reference, leap.size, math::significant(leap.begin, 12),
                        leap.of_counts ? reference : counts, "their clock was set");
}

}  // namespace

measurement::Dataset without_clock_leaps(measurement::Dataset opened) {
  if (opened.has_motions_alone()) return opened;
  ingest::Repairs repairs(opened.recordings.view());
  for (std::size_t i = 0; i < opened.recordings.size(); ++i) {
    std::vector<Leap> gaps = gaps_of_one_stream(opened.recordings[i]);
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      const Leap leap = gaps[k];
      const Recording& so_far = repairs.any() ? repairs.own(i) : opened.recordings[i];
      if (!is_a_leap(so_far, leap)) continue;
      Recording& recording = repairs.own(i);
      put_back(recording, leap);
      recording.repairs.push_back(repair_of(recording, leap));
      // Gaps behind it are those of the same stream.
      for (Leap& later : gaps)
        if (later.of_counts == leap.of_counts && later.begin > leap.begin) later.begin -= leap.size;
    }
  }
  if (!repairs.any()) return opened;
  auto mended = measurement::open_dataset(std::move(repairs).take(opened.recordings.stamps()));
  return mended ? std::move(mended).value() : opened;
}

}  // namespace odomcalib::calib::estimation
