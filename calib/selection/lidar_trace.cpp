#include "calib/selection/lidar_trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/selection/lidar_score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/lidar_smooth_term.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

std::vector<double> slice(const Eigen::VectorXd& all, Eigen::Index first, Eigen::Index count) {
  return {all.data() + first, all.data() + first + count};
}

/// Large enough to matter, and no larger than devices can be wrong.
bool is_plausible(const terms::LidarEffect& effect, const std::vector<double>& values) {
  const auto& parameters = effect.parameters();
  double size = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    size = std::max(size, std::abs(values[k]) / parameters[k].negligible);
    if (std::abs(values[k]) > parameters[k].largest) return false;
  }
  return size > 1.0;
}

std::vector<double> bearings_in(const std::vector<measurement::HeadingPair>& pairs) {
  std::vector<double> all;
  for (const measurement::HeadingPair& pair : pairs)
    for (const measurement::DoubleSighting& point : pair.points) {
      all.push_back(point.first.bearing);
      all.push_back(point.second.bearing);
    }
  return all;
}

/// No value of it is beyond what chance leaves.
bool is_superfluous(const terms::LidarFinding& finding) {
  for (std::size_t k = 0; k < finding.values.size(); ++k)
    if (std::abs(finding.values[k]) > validation::settings::kNormal95 * finding.deviations[k]) return false;
  return finding.effect->is_named();
}

class LidarTrace {
 public:
  LidarTrace(const std::vector<measurement::HeadingPair>& pairs,
             const std::vector<terms::LidarEffectPtr>& candidates, const RuleSet& rules)
      : scores_(pairs, candidates), rules_(rules), refused_(candidates.size(), false) {}

  std::vector<terms::LidarFinding> run() {
    while (accepted_.size() < settings::kMostLidarFindings && add_best()) {
    }
    return findings();
  }

  std::vector<terms::LidarFinding> fit_all() {
    for (std::size_t c = 0; c < refused_.size(); ++c) add(c, 1.0, scores_.held_out(accepted_, c));
    return findings();
  }

 private:
  [[nodiscard]] double penalised(const LidarScores::Score& score) const {
    return score.statistic -
           static_cast<double>(score.degrees) * std::log(static_cast<double>(scores_.pair_count()));
  }

  /// The best candidate that holds; false when there is none.
  bool add_best() {
    const auto scores = scores_.score(accepted_);
    for (const std::size_t c : in_order(scores)) {
      if (refused_[c]) continue;
      const auto validation = scores_.held_out(accepted_, c);
      const bool holds = (validation.z >= effect(c).least_z() && is_worthwhile(c, validation)) ||
                         !rules_.has(Rule::lidar_gain);
      if (!holds || (!matters(c) && rules_.has(Rule::lidar_size))) {
        refused_[c] = true;
        if (holds) refuse_lesser_names(c, scores);
        continue;
      }
      add(c, scores[c].family_p_value, validation);
      eliminate_superfluous();
      return true;
    }
    return false;
  }

  /// An error that is too small as a free term is no larger under a name that explains too little of it.
  void refuse_lesser_names(std::size_t smooth, const std::vector<LidarScores::Score>& scores) {
    if (effect(smooth).is_named()) return;
    for (std::size_t c = 0; c < scores.size(); ++c)
      if (effect(c).is_named() && effect(c).covariate() == effect(smooth).covariate() &&
          scores[c].statistic < effect(c).share_of_free_term() * scores[smooth].statistic &&
          rules_.has(Rule::lidar_part_of_an_error))
        refused_[c] = true;
  }

  /// Significant candidates, the best first; a name before the free smooth term on its own ground unless that
  /// explains much more.
  [[nodiscard]] std::vector<std::size_t> in_order(const std::vector<LidarScores::Score>& scores) const {
    std::vector<std::size_t> order;
    for (std::size_t c = 0; c < scores.size(); ++c)
      if (scores[c].degrees > 0 && !refused_[c] &&
          (scores[c].family_p_value <= settings::kLidarLevel || !rules_.has(Rule::lidar_significance)))
        order.push_back(c);
    const auto rank = [&](std::size_t c) { return penalised(scores[c]); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });
    const auto is_name_of_best = [&](std::size_t c) {
      const terms::LidarEffect &own = effect(c), &best = effect(order.front());
      return own.is_named() && !best.is_named() && own.covariate() == best.covariate() &&
             scores[c].statistic > own.share_of_free_term() * scores[order.front()].statistic;
    };
    const auto name = std::find_if(order.begin(), order.end(), is_name_of_best);
    if (name != order.end()) std::rotate(order.begin(), name, name + 1);
    return order;
  }

  [[nodiscard]] const terms::LidarEffect& effect(std::size_t candidate) const {
    return *scores_.candidates()[candidate].effect;
  }

  [[nodiscard]] bool is_worthwhile(std::size_t candidate, const LidarScores::Gain& validation) const {
    return validation.after * validation.after <
           effect(candidate).may_leave() * validation.before * validation.before;
  }

  [[nodiscard]] bool matters(std::size_t candidate) const {
    std::vector<std::size_t> more = accepted_;
    more.push_back(candidate);
    const LidarFit fit = scores_.fit(more);
    const auto count = scores_.candidates()[candidate].count;
    return is_plausible(*scores_.candidates()[candidate].effect,
                        slice(fit.values, fit.values.size() - count, count));
  }

  void add(std::size_t candidate, double p_value, const LidarScores::Gain& validation) {
    accepted_.push_back(candidate);
    evidence_.push_back(
        {scores_.candidates()[candidate].effect, {}, {}, p_value, validation.before, validation.after});
    refused_[candidate] = true;
  }

  /// A name that was only the best there was is none beside the term that was added last (Wald test, 5 %).
  void eliminate_superfluous() {
    const std::vector<terms::LidarFinding> all = findings();
    for (std::size_t k = all.size() - 1; k-- > 0;)
      if (is_superfluous(all[k]) && rules_.has(Rule::lidar_elimination)) {
        accepted_.erase(accepted_.begin() + static_cast<std::ptrdiff_t>(k));
        evidence_.erase(evidence_.begin() + static_cast<std::ptrdiff_t>(k));
      }
  }

  [[nodiscard]] std::vector<terms::LidarFinding> findings() const {
    std::vector<terms::LidarFinding> all = evidence_;
    const LidarFit fit = scores_.fit(accepted_);
    Eigen::Index first = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto count = scores_.candidates()[accepted_[k]].count;
      all[k].values = slice(fit.values, first, count);
      all[k].deviations = slice(fit.deviations, first, count);
      first += count;
    }
    return all;
  }

  LidarScores scores_;
  RuleSet rules_;
  std::vector<std::size_t> accepted_;
  std::vector<bool> refused_;
  std::vector<terms::LidarFinding> evidence_;
};

/// Slope of all errors that are left in the scans.
double slope(const std::vector<terms::LidarFinding>& findings, double bearing, double range) {
  const double step = settings::kHalfStep * range;
  double rise = 0.0;
  for (const terms::LidarFinding& finding : findings) {
    if (finding.effect->is_correctable()) continue;
    const auto error = [&](double r) { return finding.effect->total({bearing, r}, finding.values).radial; };
    rise += error(range + step) - error(range - step);
  }
  return rise / (2.0 * step);
}

}  // namespace

std::vector<terms::LidarFinding> trace_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                             bool all_round, bool ranges_are_judged, const RuleSet& rules) {
  if (pairs.size() < settings::kFewestHeadingPairs) return {};
  std::vector<terms::LidarEffectPtr> candidates = terms::lidar_catalogue(all_round);
  for (const auto& smooth : terms::lidar_smooths()) candidates.push_back(smooth);
  if (auto sector = terms::make_sector_error(bearings_in(pairs))) candidates.push_back(std::move(sector));
  if (ranges_are_judged)
    std::erase_if(candidates, [](const terms::LidarEffectPtr& effect) { return effect->is_judged_in_map(); });
  return LidarTrace(pairs, candidates, rules).run();
}

std::vector<terms::LidarFinding> fit_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                           const std::vector<terms::LidarEffectPtr>& effects) {
  if (pairs.empty()) return {};
  return LidarTrace(pairs, effects, {}).fit_all();
}

double range_scale_uncertainty(const std::vector<terms::LidarFinding>& findings,
                               std::span<const Recording> recordings) {
  double squares = 0.0, count = 0.0;
  for (const Recording& recording : recordings)
    for (std::size_t s = 0; s < recording.scans.size();
         s += 1 + recording.scans.size() / settings::kScansOfScale) {
      const Scan& scan = recording.scans[s];
      for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
        const auto range = static_cast<double>(scan.ranges[k]);
        if (!(range > 0.0)) continue;
        const double own = slope(findings, scan.angle(k), range);
        squares += own * own;
        ++count;
      }
    }
  return count > 0.0 ? 0.5 * std::sqrt(squares / count) : 0.0;
}

}  // namespace odomcalib::calib::selection
