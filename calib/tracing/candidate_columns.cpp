#include "calib/tracing/candidate_columns.hpp"

#include <memory>

#include "calib/estimators/stack.hpp"
#include "calib/model/sensitivity.hpp"

namespace odomcalib::calib {
namespace {

/// The fit along which all candidates are tried.
class Columns {
 public:
  Columns(std::span<const FitData> data, const EffectList& effects, const FitResult& fit)
      : stack_(make_stack(data, effects, fit.parameters, false)) {
    for (const FitData& d : data)
      trajectories_.push_back(d.model->trajectory(as_span(fit.parameters), effects));
    for (std::size_t d = 0; d < data.size(); ++d) {
      sensitivities_.push_back(
          std::make_unique<Sensitivity>(*data[d].model, trajectories_[d], intervals_of(data[d].pairs)));
      whiteners_.push_back(whitener_of(data, stack_, fit.noise[d], fit.weights, d));
    }
  }

  [[nodiscard]] Eigen::MatrixXd of(const EffectList& candidates) const {
    const std::vector<double> starts = start_of(candidates);
    Eigen::MatrixXd columns(stack_.residual.rows(), static_cast<Eigen::Index>(starts.size()));
    for (std::size_t d = 0; d < sensitivities_.size(); ++d) {
      Eigen::MatrixXd rows = sensitivities_[d]->by_more(candidates, starts);
      whiteners_[d].apply(rows);
      columns.middleRows(static_cast<Eigen::Index>(3 * stack_.first[d]), rows.rows()) = rows;
    }
    return columns;
  }

 private:
  Stack stack_;
  std::vector<Trajectory> trajectories_;
  std::vector<std::unique_ptr<Sensitivity>> sensitivities_;
  std::vector<Whitener> whiteners_;
};

/// As many candidates from `first` on as one sweep of automatic derivatives carries, and one at least.
EffectList sweep_from(const EffectList& candidates, std::size_t first) {
  EffectList sweep;
  std::size_t parameters = 0;
  for (std::size_t k = first; k < candidates.size(); ++k) {
    parameters += candidates[k]->parameters().size();
    if (parameters > kJetSize && !sweep.empty()) break;
    sweep.push_back(candidates[k]);
  }
  return sweep;
}

}  // namespace

std::vector<Eigen::MatrixXd> candidate_columns(std::span<const FitData> data, const EffectList& effects,
                                               const FitResult& fit, const EffectList& candidates) {
  const Columns fitted(data, effects, fit);
  std::vector<Eigen::MatrixXd> columns;
  while (columns.size() < candidates.size()) {
    const EffectList sweep = sweep_from(candidates, columns.size());
    const Eigen::MatrixXd all = fitted.of(sweep);
    Eigen::Index first = 0;
    for (const auto& candidate : sweep) {
      const auto size = static_cast<Eigen::Index>(candidate->parameters().size());
      columns.emplace_back(all.middleCols(first, size));
      first += size;
    }
  }
  return columns;
}

}  // namespace odomcalib::calib
