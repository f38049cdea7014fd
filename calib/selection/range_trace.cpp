#include "calib/selection/range_trace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/math/settings.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/lidar_smooth_term.hpp"

namespace odomcalib::calib::selection {
namespace {

/// A map, and the error of the ranges that it was adjusted with.
struct Adjusted {
  measurement::WallMap map;
  measurement::PlaceOptions options;
  measurement::RangeEvidence evidence;  ///< what is left
};

using Step = measurement::RangeErrorTerms (*)(const measurement::RangeEvidence&);

measurement::RangeErrorTerms offset_step(const measurement::RangeEvidence& evidence) {
  return evidence.offset_alone * measurement::RangeErrorTerms::Unit(0);
}

/// The offset stays what it is: it was fitted first.
measurement::RangeErrorTerms slant_step(const measurement::RangeEvidence& evidence) {
  measurement::RangeErrorTerms step = evidence.values;
  step(0) = 0.0;
  return step;
}

Adjusted adjusted_with(Step step, Adjusted state, measurement::PlacedBeams used) {
  for (int pass = 0; pass < settings::kRangePasses; ++pass) {
    const measurement::RangeErrorTerms change = step(state.evidence);
    state.options.range_error += change;
    state.evidence = adjust_map(used.beams, state.options, state.map, used.places);
    if (change.cwiseAbs().maxCoeff() < settings::kRangeSettled_m) break;
  }
  return state;
}

struct Misfit {
  double squares = 0.0;  ///< m^2
  double readings = 0.0;
};

/// Misfit of one scan, placed anew.
Misfit misfit_of(const Adjusted& state, const std::vector<measurement::Beam>& beams,
                 const math::Pose& guess) {
  const measurement::Place place = place_scan(state.map, beams, guess, state.options);
  Misfit misfit;
  if (!place.is_usable()) return misfit;
  for (const measurement::RangeTerm& term : fitting_terms(state.map, beams, place.pose, state.options)) {
    misfit.squares += term.residual * term.residual;
    misfit.readings += 1.0;
  }
  return misfit;
}

struct RangeGain {
  double before = 0.0, after = 0.0;  ///< m, RMS of the readings against the map
  double z = 0.0;                    ///< mean gain per scan in its standard deviations
};

RangeGain prove(const Adjusted& before, const Adjusted& after, const measurement::PlacedBeams& others) {
  Misfit all_before, all_after;
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < others.beams.size(); ++k) {
    const Misfit a = misfit_of(before, others.beams[k], others.places[k].pose);
    const Misfit b = misfit_of(after, others.beams[k], others.places[k].pose);
    if (a.readings == 0.0 || b.readings == 0.0) continue;
    all_before = {all_before.squares + a.squares, all_before.readings + a.readings};
    all_after = {all_after.squares + b.squares, all_after.readings + b.readings};
    const double gain = a.squares / a.readings - b.squares / b.readings;
    sum += gain;
    squares += gain * gain;
    count += 1.0;
  }
  if (count < 2.0) return {};
  const double variance = squares / count - std::pow(sum / count, 2);
  return {std::sqrt(all_before.squares / all_before.readings),
          std::sqrt(all_after.squares / all_after.readings),
          sum / count / std::sqrt(std::max(variance, std::numeric_limits<double>::min()) / count)};
}

terms::LidarFinding range_finding(terms::LidarEffectPtr effect, double p_value, const RangeGain& validation,
                                  const Eigen::VectorXd& values, const Eigen::VectorXd& deviations) {
  return {std::move(effect),
          {values.begin(), values.end()},
          {deviations.begin(), deviations.end()},
          p_value,
          validation.before,
          validation.after};
}

/// The change that allowing for the incidence would make counts as unknown too.
double deviation_of_offset(const measurement::RangeEvidence& left) {
  return std::hypot(left.offset_alone_deviation, left.values(0) - left.offset_alone);
}

class RangeTracing {
 public:
  RangeTracing(Adjusted state, const measurement::PlacedBeams& used, const measurement::PlacedBeams& others,
               const RuleSet& rules)
      : state_(std::move(state)), used_(used), others_(others), rules_(rules) {}

  measurement::RangeTrace run() {
    measurement::RangeTrace trace;
    if (shows_offset(state_.evidence)) trace.findings = offset();
    trace.offset = state_.options.range_error(0);
    trace.map = state_.map;
    if (shows_slant(state_.evidence)) {
      const auto more = slant();
      trace.findings.insert(trace.findings.end(), more.begin(), more.end());
    }
    return trace;
  }

 private:
  /// None where what is left, once it is taken out, would undo a good part of it: then it stood for something
  /// else. Nor where scans that were not used do not confirm it.
  std::vector<terms::LidarFinding> offset() {
    const double p_value = p_value_of_offset(state_.evidence);
    Adjusted better = adjusted_with(offset_step, state_, used_);
    const double value = better.options.range_error(0), deviation = deviation_of_offset(better.evidence);
    if (std::abs(value) < math::settings::kClearSigmas * deviation && rules_.has(Rule::range_gain)) return {};
    const auto validation = advance(std::move(better));
    if (!validation) return {};
    return {range_finding(terms::make_range_bias(), p_value, *validation, Eigen::VectorXd::Constant(1, value),
                          Eigen::VectorXd::Constant(1, deviation))};
  }

  /// None where next to nothing is left once the map has settled: what was gained then is the map's.
  std::vector<terms::LidarFinding> slant() {
    const double p_value = p_value_of_slant(state_.evidence);
    Adjusted better = adjusted_with(slant_step, state_, used_);
    if (!measurement::matters_at_a_slant(better.options.range_error)) return {};
    const auto validation = advance(std::move(better));
    if (!validation) return {};
    const measurement::RangeErrorTerms deviations = state_.evidence.covariance.diagonal().cwiseSqrt();
    return {range_finding(terms::make_incidence_error(), p_value, *validation,
                          state_.options.range_error.tail<measurement::kRangeCoefficients - 1>(),
                          deviations.tail<measurement::kRangeCoefficients - 1>())};
  }

  /// To a state that scans that were not used confirm.
  std::optional<RangeGain> advance(Adjusted better) {
    const RangeGain validation = prove(state_, better, others_);
    if (validation.z < settings::kHeldOutZ && rules_.has(Rule::range_gain)) return std::nullopt;
    state_ = std::move(better);
    return validation;
  }

  Adjusted state_;
  const measurement::PlacedBeams& used_;
  const measurement::PlacedBeams& others_;
  RuleSet rules_;
};

}  // namespace

measurement::RangeTrace trace_ranges(const measurement::RangeEvidence& evidence,
                                     const measurement::PlacedBeams& used,
                                     const measurement::PlacedBeams& others,
                                     const measurement::PlaceOptions& options,
                                     const measurement::WallMap& map, const RuleSet& rules) {
  return RangeTracing({map, options, evidence}, used, others, rules).run();
}

}  // namespace odomcalib::calib::selection
