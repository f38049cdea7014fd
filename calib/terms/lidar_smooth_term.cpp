#include "calib/terms/lidar_smooth_term.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <string>

#include "calib/math/median.hpp"
#include "calib/math/se2.hpp"
#include "calib/terms/settings.hpp"

namespace odomcalib::calib::terms {
namespace {

/// One for each function of the covariate, numbered.
std::vector<LidarParameter> numbered_parameters(bool radial, std::size_t size) {
  const LidarParameter one =
      radial ? LidarParameter{"radial", "m", settings::kSmallShift_m, settings::kLargestShift_m}
             : LidarParameter{"angular", "rad", settings::kSmallAngle_rad, settings::kLargestAngle_rad};
  std::vector<LidarParameter> all(size, one);
  for (std::size_t k = 0; k < size; ++k) all[k].name += std::to_string(k + 1);
  return all;
}

/// Row of a dependence that no named effect stands for: its name is the covariate.
LidarEffectRow unnamed_row(const std::string& covariate, bool radial, std::size_t size) {
  return {.name = covariate,
          .is_named = false,
          .covariate = covariate,
          .parameters = numbered_parameters(radial, size)};
}

class UnnamedError : public LidarEffect {
 public:
  UnnamedError(LidarEffectRow row, bool radial) : LidarEffect(std::move(row)), radial_(radial) {}
  [[nodiscard]] std::vector<BeamShift> shifts(const Sighting& sighting) const override {
    std::vector<BeamShift> all;
    all.reserve(parameters().size() + 1);
    for (const double f : functions(sighting)) all.push_back(radial_ ? BeamShift{f, 0.0} : BeamShift{0.0, f});
    return all;
  }

 protected:
  [[nodiscard]] virtual std::vector<double> functions(const Sighting& sighting) const = 0;

 private:
  bool radial_;
};

/// Three harmonics.
class OfBearing final : public UnnamedError {
 public:
  explicit OfBearing(bool radial) : UnnamedError(unnamed_row("bearing", radial, 6), radial) {}

 private:
  [[nodiscard]] std::vector<double> functions(const Sighting& s) const override {
    std::vector<double> all;
    all.reserve(6);
    const std::complex<double> turn = std::polar(1.0, s.bearing);
    std::complex<double> here = turn;
    for (int k = 1; k <= 3; ++k, here *= turn) {
      all.push_back(here.real());
      all.push_back(here.imag());
    }
    return all;
  }
};

/// Hats every 15 degrees, less the mean of all that are seen, which is an offset: what a cover, a post or a
/// reflection does to part of the view, harmonics would spread over all of it.
class OfSector final : public UnnamedError {
 public:
  /// @param knots that are seen, two at least
  explicit OfSector(std::vector<std::size_t> knots)
      : UnnamedError(row(knots), true), knots_(std::move(knots)) {}

  /// No scan shows well what all parts have in common: most of the view is taken to be right.
  [[nodiscard]] BeamShift total(const Sighting& sighting, std::span<const double> values) const override {
    std::vector<double> at_knots{0.0};
    at_knots.insert(at_knots.end(), values.begin(), values.end());
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(at_knots.size());
    BeamShift shift = UnnamedError::total(sighting, values);
    shift.radial -= math::median_of(std::move(at_knots)) - mean;
    return shift;
  }

  static double place_of(double bearing) {
    return static_cast<double>(settings::kBearingKnots) * math::angle_of_turn(bearing) / (2.0 * math::kPi);
  }

 private:
  static LidarEffectRow row(const std::vector<std::size_t>& knots) {
    LidarEffectRow row = unnamed_row("bearing", true, knots.size() - 1);
    for (std::size_t k = 0; k < row.parameters.size(); ++k)
      row.parameters[k].name = "radial_at_" + std::to_string(360 / settings::kBearingKnots * knots[k + 1]);
    // An obstacle that hides part of a view is no small thing; small bends of the whole are harmonics.
    row.may_leave = 0.85;
    return row;
  }
  static double hat(double place, std::size_t knot) {
    const double apart = std::abs(place - static_cast<double>(knot));
    return std::max(0.0, 1.0 - std::min(apart, static_cast<double>(settings::kBearingKnots) - apart));
  }
  [[nodiscard]] std::vector<double> functions(const Sighting& s) const override {
    const double place = place_of(s.bearing);
    std::vector<double> all;
    all.reserve(knots_.size());
    double mean = 0.0;
    for (const std::size_t knot : knots_) {
      all.push_back(hat(place, knot));
      mean += all.back() / static_cast<double>(knots_.size());
    }
    all.erase(all.begin());
    for (double& f : all) f -= mean;
    return all;
  }

  std::vector<std::size_t> knots_;
};

/// Hats over the logarithm of the range, of equal height from the nearest knot inwards and the farthest
/// outwards. What they have in common with a scale no scan shows.
class OfRange final : public UnnamedError {
 public:
  OfRange() : UnnamedError(row(), true) {}

 private:
  static LidarEffectRow row() {
    LidarEffectRow row = unnamed_row("range", true, settings::kRangeKnots);
    row.is_correctable = false;
    return row;
  }
  [[nodiscard]] std::vector<double> functions(const Sighting& s) const override {
    const double place = std::clamp(std::log2(std::max(s.range, 1e-3) / settings::kNearestRange_m), 0.0,
                                    static_cast<double>(settings::kRangeKnots - 1));
    std::vector<double> all;
    for (std::size_t k = 0; k < settings::kRangeKnots; ++k)
      all.push_back(std::max(0.0, 1.0 - std::abs(place - static_cast<double>(k))));
    return all;
  }
};

class OfIncidence final : public UnnamedError {
 public:
  OfIncidence() : UnnamedError(row(), true) {}

 private:
  static LidarEffectRow row() {
    LidarEffectRow row = unnamed_row("incidence", true, 4);
    row.is_correctable = false;
    row.is_judged_in_map = true;
    return row;
  }
  [[nodiscard]] std::vector<double> functions(const Sighting& s) const override {
    const auto values = slants(s);
    return {values.begin(), values.end()};
  }
};

}  // namespace

std::array<double, 4> slants(const Sighting& s) {
  const double slant = std::clamp(std::tan(s.incidence), -3.0, 3.0);
  return {std::abs(slant), slant, std::abs(slant) * s.range, slant * s.range};
}

LidarEffectPtr make_incidence_error() { return std::make_shared<OfIncidence>(); }

LidarEffectPtr make_sector_error(const std::vector<double>& bearings) {
  std::array<std::size_t, settings::kBearingKnots> seen{};
  for (const double bearing : bearings)
    ++seen.at(static_cast<std::size_t>(std::round(OfSector::place_of(bearing))) % settings::kBearingKnots);
  std::vector<std::size_t> knots;
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (seen.at(k) >= settings::kFewestReadings) knots.push_back(k);
  return knots.size() < 2 ? nullptr : std::make_shared<OfSector>(std::move(knots));
}

std::vector<LidarEffectPtr> lidar_smooths() {
  return {std::make_shared<OfBearing>(true), std::make_shared<OfBearing>(false), std::make_shared<OfRange>(),
          make_incidence_error()};
}

}  // namespace odomcalib::calib::terms
