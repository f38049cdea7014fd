// Stamps as they were given, or evenly spread ones: what the motion says.
#pragma once

#include <vector>

namespace odomcalib::calib::ingest {

/// Errors that a prediction makes with either of two sets of stamps. Those with wrong stamps contain what
/// lies between both, those with the right ones have nothing to do with it: the share of the difference
/// d = given - even that is found in the errors with the given stamps, by robust regression, is one when the
/// even ones are right and zero when they are not.
class StampContest {
 public:
  /// @param given, even errors with either, in units of their deviation
  void add(double given, double even) { errors_.push_back({given, given - even}); }

  /// Whether the share exceeds one half by three standard deviations.
  [[nodiscard]] bool is_for_even() const;

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

}  // namespace odomcalib::calib::ingest
