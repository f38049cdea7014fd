#include "calib/ingest/stamp_check.hpp"

#include <algorithm>
#include <string>

#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "proto/recording/stamp_units.hpp"

namespace odomcalib::calib::ingest {
namespace {

constexpr const char* kWriteDigits =
    "write stamps with at least three digits after the point, as double-precision numbers";

}  // namespace

std::optional<Error> lost_digits(const Recording& recording, Form form) {
  const std::size_t repeated = left_out(recording, form, kRepeatedStamp);
  const std::size_t kept = stamps_of(recording, form).size();
  const auto all = static_cast<double>(kept + repeated);
  if (!(static_cast<double>(repeated) > kRepeatedShare * all)) return std::nullopt;
  const std::string many = many_of(form);
  if (kept < 2)
    return Error{ErrorCode::format,
                 "all " + std::to_string(kept + repeated) + " " + many + " carry one time stamp",
                 recording.name, "stamp each with the time it was measured at"};
  return Error{
      ErrorCode::format,
      std::to_string(repeated) + " of " + std::to_string(kept + repeated) + " " + many +
          " carry the same time stamp as the one before: the stamps have lost their last digits, as whole "
          "seconds or single-precision numbers do",
      recording.name, kWriteDigits};
}

std::optional<Error> clock_was_set(const Recording& recording, Form form) {
  const std::vector<double> stamps = stamps_of(recording, form);
  if (stamps.size() < 2) return std::nullopt;
  // Where every step is that long, times are in another unit.
  const double usual = math::median_of(math::differences_of(stamps));
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const double step = stamps[k] - stamps[k - 1];
    if (step < std::max(settings::kClockSet_s, settings::kUnlikeOthers * usual)) continue;
    const bool since_boot = stamps[k - 1] < kEarliestDate_s && stamps[k] >= kEarliestDate_s;
    return Error{
        ErrorCode::format,
        "the times of the " + std::string(many_of(form)) + " jump by " + math::significant(step, 4) +
            " s after " + std::to_string(k) + " of " + std::to_string(stamps.size()) + ": " +
            (since_boot ? "their clock counted since it was switched on, and was set to the date while "
                          "recording"
                        : "their clock was set while recording"),
        recording.name, "record again once the clock is set, or leave out what lies before the jump"};
  }
  return std::nullopt;
}

std::optional<Error> no_dates(const Recording& recording, Form form) {
  for (const Discarded& discarded : recording.discarded)
    if (discarded.what == name_of(form))
      if (const std::string unit = unit_of_reason(discarded.reason); !unit.empty())
        return wrong_dates(discarded.what, discarded.count, unit, recording.name);
  return std::nullopt;
}

}  // namespace odomcalib::calib::ingest
