#include "calib/selection/wrong_name.hpp"

#include <utility>

namespace odomcalib::calib::selection {
namespace {

/// A moment is sought among all of the drive: with fewer sizes than a name it is no plainer.
bool is_plainly_an_event(const FittedModel& named, const Reshaped& law) {
  return named.fit.cost - law.model.fit.cost > schwarz(named.fit);
}

}  // namespace

std::optional<FreeLaw> free_law_instead_of(const FitTask& task, const FittedModel& model, std::size_t index,
                                           const Candidate& candidate) {
  const auto without = without_effect(task, model, index, {});
  if (!without) return std::nullopt;
  auto law = in_best_shape(task, *without, *candidate.curve, model.fit.noise);
  if (!law || explains_nearly_all(task, model, index, law->model) ||
      !is_better(task, model, law->model, schwarz(model.fit)))
    return std::nullopt;
  if (happens_at_once(law->curve) && !is_plainly_an_event(model, *law)) return std::nullopt;
  Proof proof;
  const auto missing = objection(task, *without, law->model, all_folds(), largest_ratio(candidate), proof);
  return missing.empty() ? std::optional(FreeLaw{std::move(*law), proof}) : std::nullopt;
}

}  // namespace odomcalib::calib::selection
