#include "calib/tracing/settled_shape.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "calib/curves/basis.hpp"
#include "calib/tracing/law_shape.hpp"

namespace odomcalib::calib {
namespace {

/// Costs compare on the same noise only; while noise was estimated, that of the step before was used.
void fit_anew_on_own_noise(const FitTask& task, FittedModel& model) {
  if (auto again = task.fit(model.effects, model.fit.parameters, model.fit.noise))
    model.fit = std::move(*again);
}

/// A law of a speed or a force has a peak or a step, not one bend after the other: those stand for the single
/// manoeuvres of this drive. Bends of less than a quarter of all that the law spans are none.
bool bends_too_often(const Reshaped& shape) {
  constexpr double kPlain = 0.25;
  constexpr int kMost = 3;
  if (shape.curve.period > 0.0 || shape.curve.law.variable == Variable::time) return false;
  const auto count = static_cast<Eigen::Index>(basis_size(shape.curve));
  const Eigen::VectorXd values = shape.model.fit.parameters.tail(count);
  const double plain = kPlain * (values.maxCoeff() - values.minCoeff());
  int bends = 0;
  double from = values(0), way = 0.0;  // of the last plain rise or fall
  for (Eigen::Index k = 1; k < count; ++k) {
    const double change = values(k) - from;
    if (std::abs(change) <= plain) continue;
    if (change * way < 0.0) ++bends;
    way = change;
    from = values(k);
  }
  return bends > kMost;
}

void take_shape(const Reshaped& shape, SearchResult& result) {
  result.model = shape.model;
  result.curves.back().curve = shape.curve;
  result.curves.back().effect = shape.model.effects.back();
}

}  // namespace

void settle_shape_of_newest_curve(const FitTask& task, SearchResult& result) {
  fit_anew_on_own_noise(task, result.model);
  const Reshaped first{result.curves.back().curve, result.model};
  std::vector<Reshaped> shapes = reshaped(task, first.model, first.curve);
  for (const Reshaped& other : shapes)
    if (!bends_too_often(other) && is_better(task, result.model, other.model, kAkaike))
      take_shape(other, result);
  shapes.push_back(first);
  if (takes_an_event(result.curves.back().curve))
    take_shape(most_sensible_event(shapes, result.model.fit.cost + kAkaike), result);
  for (const Reshaped& other : shapes)
    if (other.model.fit.cost < result.model.fit.cost + schwarz(result.model.fit))
      result.doubts.emplace_back(other.model.base() - result.model.base());
  result.doubts.push_back(doubt_of_zero(task, result.model, result.curves.back().curve));
}

}  // namespace odomcalib::calib
