#include "calib/report/unexplained.hpp"

#include <algorithm>

#include "calib/selection/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// What stays without a name, put together from its parts.
class UnnamedSummary {
 public:
  void mention(const std::string& covariate) {
    auto& names = all_.depends_on;
    if (std::find(names.begin(), names.end(), covariate) == names.end()) names.push_back(covariate);
  }
  void add(const std::string& covariate, double p_value, double before, double after) {
    if (all_.depends_on.empty()) all_.p_value = p_value;
    mention(covariate);
    const double ratio = before > 0.0 ? after / before : 1.0;
    left_ *= std::min(ratio * ratio, 1.0);
  }
  [[nodiscard]] std::optional<Unexplained> result() const {
    if (all_.depends_on.empty()) return std::nullopt;
    Unexplained out = all_;
    out.share = 1.0 - left_;
    return out;
  }

 private:
  Unexplained all_;
  double left_ = 1.0;  // of the squared error
};

/// What goes with covariates, but is no part of the model.
std::optional<Unexplained> flagged(const std::vector<vehicle::Covariate>& covariates, double p_value) {
  if (covariates.empty()) return std::nullopt;
  Unexplained unexplained{{}, p_value, 0.0};
  for (const vehicle::Covariate covariate : covariates)
    unexplained.depends_on.push_back(to_string(covariate));
  return unexplained;
}

}  // namespace

std::optional<Unexplained> unnamed_smooths(const Findings& found) {
  UnnamedSummary summary;
  for (const terms::LidarFinding& finding : found.lidar)
    if (!finding.effect->is_named() && !completes(finding, found.lidar))
      summary.add(finding.effect->name(), finding.family_p_value, finding.before, finding.after);
  for (const selection::AddedSmoothTerm& added : found.outcome.smooths)
    if (!added.named_term)
      summary.add(to_string(added.smooth.dependence.covariate), added.validation.family_p_value,
                  added.validation.before, added.validation.after);
  for (const selection::AddedSmoothTerm& added : found.outcome.smooths) {
    if (added.named_term) continue;
    for (const vehicle::Covariate covariate : added.alike) summary.mention(to_string(covariate));
  }
  return summary.result();
}

std::optional<Unexplained> flagged_outliers(const selection::OutlierTrace& outliers) {
  return flagged(outliers.depends_on, outliers.p_value);
}

std::optional<Unexplained> failed_validation(const selection::SearchResult& outcome) {
  const selection::Considered* best = nullptr;
  for (const selection::Considered& one : outcome.considered)
    if (!one.depends_on.empty() && one.family_p_value <= selection::settings::kNamedLevel &&
        (best == nullptr || one.statistic > best->statistic))
      best = &one;
  return best == nullptr ? std::nullopt : flagged(best->depends_on, best->family_p_value);
}

}  // namespace odomcalib::calib::report
