// Each term looks at no more of the drive than it states: what is left out is not computed.
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::terms::covariates_test {
namespace {

using vehicle::StepContext;

std::vector<double> steps_of(const vehicle::Effect& effect, std::span<const StepContext> contexts) {
  std::vector<double> parameters;
  for (const vehicle::EffectParameter& p : effect.parameters())
    parameters.push_back(p.is_size() ? 0.7 * p.scale : p.start);
  std::vector<double> all;
  for (const StepContext& c : contexts) {
    vehicle::WheelStep<double> step{0.075 * c.left_delta, 0.075 * c.right_delta};
    effect.apply(c, std::span<const double>(parameters), step);
    for (const double value : {step.left, step.right, step.side, step.yaw, step.track}) all.push_back(value);
  }
  return all;
}

/// Every effect and free term that may be asked for, in all its shapes.
vehicle::EffectList all_terms(const vehicle::DriveModel& model) {
  vehicle::EffectList all;
  for (const auto& effect : effect_catalogue()) {
    all.push_back(effect);
    for (const auto& variant : effect->variants()) all.push_back(variant);
  }
  const vehicle::DriveModel* const models[] = {&model};
  for (const SmoothTerm& smooth : candidate_smooths(models)) {
    all.push_back(make_smooth_term_effect(smooth));
    for (const SmoothTerm& shape : other_shapes(smooth, models))
      all.push_back(make_smooth_term_effect(shape));
  }
  return all;
}

TEST(Covariates, of_a_term_are_those_that_it_states) {
  const vehicle::DriveModel model = selection::stopping_model();
  const auto none = vehicle::make_context(model.track(), selection::kBase, {});
  vehicle::CovariateGroups groups;
  auto stated = none;
  std::size_t with_groups = 0;
  for (const auto& term : all_terms(model)) {
    if (groups != term->covariates())
      stated = make_context(model.track(), selection::kBase, term->covariates());
    groups = term->covariates();
    const auto steps = steps_of(*term, model.context());
    EXPECT_EQ(steps_of(*term, stated.intervals()), steps) << term->name();
    with_groups += steps_of(*term, none.intervals()) != steps ? 1 : 0;
  }
  EXPECT_GT(with_groups, 50U) << "the drive does not show what is left out";
}

}  // namespace
}  // namespace odomcalib::calib::terms::covariates_test
