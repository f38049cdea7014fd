// Times in files: ISO 8601, UTC, to the second.
#pragma once

#include <optional>
#include <string>

namespace odomcalib {

/// Whether a clock that shows this tells the date: a clock that counts from the start of a computer, or from
/// zero, shows less than the first seconds of 2001, and no robot drives after 9999.
/// @param t s since 1970
bool is_date(double t);

/// "2026-05-04T12:30:00Z": the second in which it lies.
/// @param t s since 1970, a date
std::string utc_text(double t);

/// "2026-11-29, 10:19 to 10:24 UTC" for people; both days where begin and end lie on two.
/// @param begin, end s since 1970, dates
std::string utc_span(double begin, double end);

/// s since 1970; nullopt for what utc_text() does not write.
std::optional<double> utc_from(const std::string& text);

}  // namespace odomcalib
