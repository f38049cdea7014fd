// The rate of a device that samples steadily, under stamps that came late by more or less.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

struct EvenStamps {
  std::vector<double> t;  ///< s, one for each stamp, never decreasing
  double jitter = 0.0;    ///< s, standard deviation of the stamps from these, by their mean absolute one
};

/// Spreads stamps evenly: index times period, and a running robust mean of what is left, which follows a
/// clock that wanders and keeps lost samples and pauses as the steps they are. Late by the mean delay.
/// Whether the device really sampled so, stamps alone do not show: see StampComparison.
/// @param stamps s, in time order
/// @return nothing when there are fewer than 50, or when they are even to 0.3 ms
std::optional<EvenStamps> even_stamps(const std::vector<double>& stamps);

/// Whether a reference is interrupted there.
/// @param times s, in time order
bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to);

/// Stamps as they were given, or evenly spread ones: what the motion says. Errors that a prediction makes
/// with either of two sets of stamps. Those with wrong stamps contain what lies between both, those with the
/// right ones have nothing to do with it: the share of the difference d = given - even that is found in the
/// errors with the given stamps, by robust regression, is one when the even ones are right and zero when they
/// are not.
class StampComparison {
 public:
  /// @param given, even errors with either, in units of their deviation
  void add(double given, double even) { errors_.push_back({given, given - even}); }

  /// Whether the share exceeds one half by three standard deviations.
  [[nodiscard]] bool even_is_better() const;

 private:
  struct Error {
    double given, difference;
  };
  struct Share {
    double value = 0.0, deviation = 0.0;
  };
  [[nodiscard]] Share share(double limit, double near) const;
  [[nodiscard]] double spread(double share) const;

  std::vector<Error> errors_;
};

/// Even stamps of the ticks, where counts grow steadily by number and not by stamp; nothing where the stamps
/// are right, or where the wheels hardly turn. Counts that were sent twice get the same stamp.
std::optional<EvenStamps> even_ticks(const Recording& recording);

}  // namespace odomcalib::calib::ingest
