// A dataset is a value: what is made from it leaves it as it is.
#include "calib/measurement/dataset.hpp"

#include <gtest/gtest.h>

#include "calib/measurement/placement.hpp"
#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::measurement::dataset_test {
namespace {

using odomcalib::test_support::driven_recording;
using odomcalib::test_support::rough_dataset;

TEST(Dataset, measured_anew_leaves_the_old_one_as_it_is) {
  const Recording recording = driven_recording({});
  const Dataset rough = rough_dataset({&recording, 1});
  const Eigen::VectorXd parameters = vehicle::to_vector(rough.nominal);
  const Dataset fine = measured(rough, parameters, {});
  EXPECT_FALSE(rough.is_measured_with(parameters)) << "rough pairs are to be measured again";
  EXPECT_TRUE(fine.is_measured_with(parameters));
  Eigen::VectorXd others = parameters;
  others(vehicle::kTrackWidth) += 1e-3;
  EXPECT_FALSE(fine.is_measured_with(others));
  EXPECT_EQ(rough.data.front().model, fine.data.front().model) << "models are shared";
}

TEST(Dataset, other_scans_of_the_same_drives_are_yet_to_be_measured) {
  const Recording recording = driven_recording({});
  const Dataset rough = rough_dataset({&recording, 1});
  const ingest::Recordings others(std::vector<Recording>{recording}, {});
  const Dataset changed = with_scans_of(rough, others);
  EXPECT_TRUE(changed.data.empty());
  EXPECT_TRUE(changed.pair_sets.empty());
  EXPECT_EQ(changed.models, rough.models);
  EXPECT_FALSE(rough.data.empty());
}

TEST(Dataset, where_the_base_was_is_known_to_the_new_models_alone) {
  const Recording recording = driven_recording({});
  const Dataset rough = rough_dataset({&recording, 1});
  const double x = rough.models.front()->context().back().x;
  const std::vector<std::vector<vehicle::Fix>> fixes{{{0.0, {}}, {119.0, {50.0, 0.0, 0.0}}}};
  const Dataset placed = located(rough, fixes, vehicle::to_vector(rough.nominal), {});
  EXPECT_NEAR(placed.data.front().model->context().back().x, 50.0, 1.0);
  EXPECT_EQ(rough.data.front().model->context().back().x, x);
}

TEST(Placement, is_of_the_recordings_that_were_placed_and_of_no_others) {
  const Recording recording = driven_recording({});
  const Dataset dataset = rough_dataset({&recording, 1});
  const vehicle::VehicleModel model{{}, vehicle::to_vector(dataset.nominal)};
  const Placement placement = place_all(dataset, model, nullptr);
  ASSERT_EQ(placement.paths.size(), 1U);
  EXPECT_TRUE(placement.is_of(dataset));
  EXPECT_FALSE(Placement{}.is_of(dataset));
  const ingest::Recordings others(std::vector<Recording>{recording}, {});
  EXPECT_FALSE(placement.is_of(with_scans_of(dataset, others)));
}

}  // namespace
}  // namespace odomcalib::calib::measurement::dataset_test
