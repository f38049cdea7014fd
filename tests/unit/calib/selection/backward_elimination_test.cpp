// Terms that leave the model again once another was added.
#include "calib/selection/backward_elimination.hpp"

#include <gtest/gtest.h>

#include "calib/selection/hyperparameters.hpp"
#include "calib/terms/catalogue.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::backward_elimination_test {
namespace {

/// A scrub that is plain, and one wheel that rolls a little shorter backwards: too little for Schwarz's
/// criterion.
class BackwardElimination : public ::testing::Test {
 protected:
  BackwardElimination() { data_ = measured(model_, {plain_, slight_}, {2e-3, 3e-5, 0.0}); }

  /// Both found, in this order.
  SearchResult found(const vehicle::EffectList& order) const {
    SearchResult result;
    result.model.effects = order;
    const auto fit = estimation::fit_joint({&data_, 1}, order,
                                           vehicle::to_vector(kBase, vehicle::count_parameters(order)));
    EXPECT_TRUE(fit) << "seed " << kSeed;
    result.model.fit = fit.value();
    for (const auto& effect : order) result.findings.push_back({effect, {}, {}});
    return result;
  }

  [[nodiscard]] FitTask task() const { return {{&data_, 1}, std::vector<bool>(vehicle::kBaseCount, false)}; }

  vehicle::DriveModel model_ = lively_model();
  std::shared_ptr<const vehicle::Effect> plain_ = terms::find_effect("turn_direction_asymmetry");
  std::shared_ptr<const vehicle::Effect> slight_ = terms::find_effect("direction_dependent_diameter");
  measurement::FitData data_;
};

TEST_F(BackwardElimination, spares_what_was_just_found) {
  SearchResult result = found({plain_, slight_});
  EXPECT_FALSE(eliminate_superfluous(task(), schwarz(result.model.fit), result));
  EXPECT_EQ(result.findings.size(), 2U);
}

TEST_F(BackwardElimination, takes_out_what_is_not_worth_its_parameters_any_more) {
  SearchResult result = found({slight_, plain_});
  EXPECT_TRUE(eliminate_superfluous(task(), schwarz(result.model.fit), result));
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings.front().effect, plain_);
  EXPECT_EQ(result.model.effects.size(), 1U);
}

}  // namespace
}  // namespace odomcalib::calib::selection::backward_elimination_test
