#include "calib/report/outlier_trace.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "calib/estimation/stack.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"
#include "calib/math/vector2.hpp"
#include "calib/report/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// A mean that is reported only where chance does not make it.
class PlainMean {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
    count_ += 1.0;
  }
  [[nodiscard]] double value() const {
    if (count_ < settings::kFewestOfCause) return 0.0;
    const double mean = sum_ / count_;
    const double variance = (squares_ / count_ - mean * mean) / (count_ - 1.0);
    return mean * mean > settings::kClearCause * settings::kClearCause * variance ? mean : 0.0;
  }

 private:
  double sum_ = 0.0, squares_ = 0.0, count_ = 0.0;
};

/// In the matcher's deviations, squared.
double length(const Eigen::Vector3d& error, const measurement::SensorPair& pair) {
  return error.cwiseAbs2().cwiseQuotient(pair.covariance.diagonal()).sum();
}

class Causes {
 public:
  /// @param error of the wheels: matched less predicted, in the sensor's frame
  void add(const measurement::FitData& data, const measurement::SensorPair& pair,
           const Eigen::Vector3d& error, const measurement::PathOfWheels& wheels) {
    const auto ends = places_at_ends(data.places, pair.interval, wheels);
    if (!ends) return;
    ++cause_.placed;
    const math::Pose placed = between(ends->begin.pose, ends->end.pose);
    if (length(math::difference(pair.motion, placed), pair) > settings::kNearPlaces * length(error, pair))
      return;
    ++cause_.confirmed;
    add_excess({pair.motion.x - error(0), pair.motion.y - error(1), pair.motion.yaw - error(2)}, error);
  }

  [[nodiscard]] OutlierCause result() const {
    OutlierCause all = cause_;
    all.farther = way_.value();
    all.turned_farther = turn_.value();
    return all;
  }

 private:
  /// Along a motion that is one; at rest there is no way to go.
  void add_excess(const math::Pose& predicted, const Eigen::Vector3d& error) {
    const double way = std::hypot(predicted.x, predicted.y);
    if (way > settings::kAtRest) way_.add((error(0) * predicted.x + error(1) * predicted.y) / way);
    if (std::abs(predicted.yaw) > settings::kAtRest) turn_.add(std::copysign(1.0, predicted.yaw) * error(2));
  }

  OutlierCause cause_;
  PlainMean way_, turn_;
};

constexpr std::size_t kBins = settings::kPlaceSlices * settings::kPlaceSlices;
constexpr unsigned kOutlierSeed = 5;

/// Events and pairs by bin of one covariate.
struct Binned {
  vehicle::Covariate covariate = vehicle::Covariate::time;
  std::vector<std::size_t> bin;  ///< of each pair
  std::vector<double> value;     ///< of each pair
};

/// The slice, of `slices` equally filled ones, that each value lies in; equal values lie in the same.
std::vector<std::size_t> sliced(const std::vector<double>& values, std::size_t slices) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::size_t> out;
  for (const double value : values) {
    const auto below = std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin();
    out.push_back(static_cast<std::size_t>(below) * slices / sorted.size());
  }
  return out;
}

/// Where an event lies so far back, how far says no more than the time does.
double farthest(vehicle::Covariate covariate) {
  if (!is_distance_since(covariate)) return std::numeric_limits<double>::infinity();
  return is_angle_of_a_wheel(covariate) ? 10.0 : 0.5;  // rad, m
}

/// Mean over a pair; of an angle, in its middle.
double value_in(vehicle::Covariate covariate, const vehicle::DriveModel& model,
                const vehicle::Interval& interval, bool of_y) {
  const auto context = model.context_within(interval);
  if (is_angle(covariate)) return math::angle_of_turn(value_of(covariate, context[(context.size() - 1) / 2]));
  const double most = farthest(covariate);
  double sum = 0.0;
  for (const vehicle::StepContext& c : context) sum += of_y ? c.y : std::min(value_of(covariate, c), most);
  return sum / static_cast<double>(context.size());
}

std::vector<double> covariate_values(vehicle::Covariate covariate, std::span<const measurement::FitData> data,
                                     bool of_y = false) {
  std::vector<double> values;
  for (const measurement::FitData& d : data)
    for (const vehicle::Interval& interval : estimation::intervals_of(d.pairs))
      values.push_back(value_in(covariate, *d.model, interval, of_y));
  return values;
}

Binned binned(vehicle::Covariate covariate, std::span<const measurement::FitData> data) {
  Binned out{covariate, {}, covariate_values(covariate, data)};
  out.bin = sliced(out.value, covariate == vehicle::Covariate::position ? settings::kPlaceSlices : kBins);
  if (covariate != vehicle::Covariate::position) return out;
  const auto across = sliced(covariate_values(covariate, data, true), settings::kPlaceSlices);
  for (std::size_t k = 0; k < across.size(); ++k)
    out.bin[k] = settings::kPlaceSlices * out.bin[k] + across[k];
  return out;
}

std::vector<Binned> all_covariates(std::span<const measurement::FitData> data) {
  std::vector<Binned> all;
  for (int k = 0; k <= static_cast<int>(vehicle::kLastCovariate); ++k) {
    const auto covariate = static_cast<vehicle::Covariate>(k);
    if (is_memory(covariate) || covariate == vehicle::Covariate::distance ||
        (data.size() > 1 && begins_with_the_recording(covariate)))
      continue;
    all.push_back(binned(covariate, data));
  }
  return all;
}

/// Log likelihood of a rate of `part` in `whole`, at its maximum.
double log_likelihood(double part, double whole) {
  return part > 0.0 && part < whole
             ? part * std::log(part / whole) + (whole - part) * std::log(1.0 - part / whole)
             : 0.0;
}

using Counts = std::array<double, kBins>;

Counts counted(const Binned& covariate, const std::vector<std::size_t>& pairs) {
  Counts counts{};
  for (const std::size_t k : pairs) ++counts.at(covariate.bin[k]);
  return counts;
}

/// -2 log likelihood ratio of one rate of events for all bins against one for each, less its expectation.
double gain_of_counts(const Counts& events, const Counts& pairs) {
  double of_bins = 0.0;
  double used = 0.0;
  for (std::size_t b = 0; b < kBins; ++b) {
    of_bins += log_likelihood(events.at(b), pairs.at(b));
    used += pairs.at(b) > 0.0 ? 1.0 : 0.0;
  }
  const double all = std::accumulate(pairs.begin(), pairs.end(), 0.0);
  const double one = log_likelihood(std::accumulate(events.begin(), events.end(), 0.0), all);
  return 2.0 * (of_bins - one) - (used - 1.0);
}

/// The first of each two outliers in a row.
std::vector<std::size_t> events_of(const estimation::FitResult& fit) {
  std::vector<std::size_t> events;
  for (std::size_t k = 0; k < fit.outlier.size(); ++k)
    if (fit.outlier[k] && (events.empty() || events.back() + 1 != k)) events.push_back(k);
  return events;
}

class Tracer {
 public:
  Tracer(std::span<const measurement::FitData> data, const std::vector<std::size_t>& events,
         std::size_t pairs)
      : covariates_(all_covariates(data)), events_(events), order_(pairs) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (const Binned& covariate : covariates_) pairs_.push_back(counted(covariate, order_));
  }

  void run(OutlierTrace& trace) {
    const std::vector<double> gains = gains_of(events_);
    const double best = *std::max_element(gains.begin(), gains.end());
    trace.p_value = chance_of(best);
    if (trace.p_value > settings::kOutlierLevel) return;
    std::vector<std::size_t> by_gain(gains.size());
    std::iota(by_gain.begin(), by_gain.end(), std::size_t{0});
    std::sort(by_gain.begin(), by_gain.end(), [&](auto a, auto b) { return gains[a] > gains[b]; });
    for (const std::size_t v : by_gain)
      if (gains[v] >= settings::kAsGood * best && trace.depends_on.size() < settings::kMostNamed)
        trace.depends_on.push_back(covariates_[v].covariate);
    if (trace.depends_on.front() == vehicle::Covariate::time) set_range(by_gain.front(), trace);
  }

 private:
  [[nodiscard]] std::vector<double> gains_of(const std::vector<std::size_t>& events) const {
    std::vector<double> gains;
    for (std::size_t v = 0; v < covariates_.size(); ++v)
      gains.push_back(gain_of_counts(counted(covariates_[v], events), pairs_[v]));
    return gains;
  }

  /// Probability that events strewn over the pairs at random gain as much by any covariate.
  double chance_of(double best) {
    std::mt19937 engine(kOutlierSeed);
    int as_good = 0;
    std::vector<std::size_t> strewn(events_.size());
    for (int draw = 0; draw < settings::kOutlierDraws; ++draw) {
      for (std::size_t k = 0; k < strewn.size(); ++k) {  // the beginning of a Fisher-Yates shuffle
        std::swap(order_[k], order_[k + engine() % (order_.size() - k)]);
        strewn[k] = order_[k];
      }
      const std::vector<double> gains = gains_of(strewn);
      as_good += *std::max_element(gains.begin(), gains.end()) >= best ? 1 : 0;
    }
    return (1.0 + as_good) / (1.0 + settings::kOutlierDraws);
  }

  /// Sets the range of the bins with unusually many events.
  void set_range(std::size_t v, OutlierTrace& trace) const {
    const Counts events = counted(covariates_[v], events_);
    const double usual = static_cast<double>(events_.size()) / static_cast<double>(order_.size());
    std::vector<double> values;
    for (const std::size_t k : events_) {
      const std::size_t bin = covariates_[v].bin[k];
      if (events.at(bin) > settings::kUnusualShare * usual * pairs_[v].at(bin))
        values.push_back(covariates_[v].value[k]);
    }
    if (values.empty()) return;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    trace.begin = *low;
    trace.end = *high;
  }

  std::vector<Binned> covariates_;
  std::vector<Counts> pairs_;  ///< by covariate
  const std::vector<std::size_t>& events_;
  std::vector<std::size_t> order_;
};

/// Cause of the outliers, as far as a map shows.
std::string to_text(const OutlierCause& cause) {
  if (cause.confirmed == 0) return "";
  std::string text = "; the map confirms " + std::to_string(cause.confirmed) + " of " +
                     std::to_string(cause.placed) + ": there the robot moved otherwise than its wheels";
  const auto excess = [&](double value, const std::string& verb, const std::string& unit) {
    if (value != 0.0)
      text += ", " + verb + " " + math::fixed(std::abs(value) / 1e-3, 1) + " " + unit +
              (value > 0.0 ? " farther" : " less far");
  };
  excess(cause.farther, "came", "mm");
  excess(cause.turned_farther, "turned", "mrad");
  return text;
}

}  // namespace

OutlierCause cause_of_outliers(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                               const estimation::FitResult& fit) {
  Causes causes;
  std::size_t k = 0;
  for (const measurement::FitData& d : data) {
    const vehicle::Trajectory trajectory = d.model->trajectory(vehicle::as_span(fit.parameters), effects);
    const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
    for (const measurement::SensorPair& pair : d.pairs) {
      if (fit.outlier[k])
        causes.add(d, pair, fit.residuals.row(static_cast<Eigen::Index>(k)).transpose(), wheels);
      ++k;
    }
  }
  return causes.result();
}

std::optional<OutlierTrace> trace_outliers(std::span<const measurement::FitData> data,
                                           const estimation::FitResult& fit) {
  const std::vector<std::size_t> events = events_of(fit);
  OutlierTrace trace{fit.discarded, fit.outlier.size(), {}, 1.0, 0.0, 0.0, {}, false};
  if (events.size() < settings::kFewestEvents ||
      static_cast<double>(trace.outliers) < settings::kFewestOutliers * static_cast<double>(trace.pairs))
    return std::nullopt;
  Tracer(data, events, trace.pairs).run(trace);
  return trace;
}

std::string to_text(const OutlierTrace& trace) {
  std::string text = std::to_string(trace.outliers) + " of " + std::to_string(trace.pairs) + " pairs of " +
                     (trace.of_poses ? "poses" : "scans") +
                     " contradict all others by more than five deviations and are left out";
  if (trace.depends_on.empty()) text += "; nothing that was observed goes with them";
  for (std::size_t k = 0; k < trace.depends_on.size(); ++k)
    text += (k > 0 ? ", " : "; they go with ") + to_string(trace.depends_on[k]);
  if (!trace.depends_on.empty() && trace.depends_on.front() == vehicle::Covariate::time)
    text += ", from " + math::fixed(trace.begin, 0) + " to " + math::fixed(trace.end, 0) + " s";
  return text + to_text(trace.cause);
}

OutlierReport entry_of(const OutlierTrace& trace) {
  std::vector<std::string> names;
  for (const vehicle::Covariate covariate : trace.depends_on) names.push_back(to_string(covariate));
  return {trace.outliers,     trace.pairs,           std::move(names),    trace.p_value,
          trace.cause.placed, trace.cause.confirmed, trace.cause.farther, trace.cause.turned_farther};
}

}  // namespace odomcalib::calib::report
