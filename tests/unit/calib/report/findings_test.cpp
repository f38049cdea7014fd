// The calibration file of a fit as it stands, without a search.
#include "calib/report/findings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/calib/driven_fit.hpp"

namespace odomcalib::calib::report::findings_test {
namespace {

/// This is a settled fit of poses that are late, given out as one of scans.
struct OfScans {
  explicit OfScans(double late) {
    Recording recording = test_support::driven_recording({});
    for (PoseSample& pose : recording.poses) pose.t += late;
    fit = test_support::settled_fit({&recording, 1});
    EXPECT_FALSE(fit->failure);
    recording.poses.clear();
    recording.scans.resize(2);
    recording.scans[1].t = 1.0;
    fit->dataset.recordings = ingest::Recordings({recording}, {});
    outcome.model = {fit->model.effects, fit->result};
  }
  /// m, standard deviation of the left diameter.
  [[nodiscard]] double stated(bool every_scan_placed) const {
    Findings found{*fit, outcome, {}};
    found.every_scan_placed = every_scan_placed;
    const Calibration calibration = calibrated(found);
    for (const auto& [name, quantity] : calibration.parameters)
      if (name == "left_wheel_diameter") return quantity.std;
    ADD_FAILURE() << "no left diameter";
    return 0.0;
  }
  std::optional<estimation::Fit> fit;
  selection::SearchResult outcome;
};

constexpr double kScale = 2e-4;  ///< relative, of a scan matcher's metre
constexpr double kDiameter = 2.0 * test_support::kLeftRadius;

double beyond(double larger, double smaller) { return std::sqrt(larger * larger - smaller * smaller); }

TEST(Findings, lengths_by_matches_of_scans_are_as_uncertain_as_the_metre_of_the_matcher) {
  const OfScans plain(0.0);
  ASSERT_TRUE(plain.outcome.model.effects.empty());
  const double placed = plain.stated(true);
  EXPECT_NEAR(placed,
              2.0 * std::sqrt(plain.fit->result.covariance(vehicle::kLeftRadius, vehicle::kLeftRadius)),
              1e-9);
  EXPECT_NEAR(beyond(plain.stated(false), placed), kScale * kDiameter, 0.02 * kScale * kDiameter);
}

TEST(Findings, lengths_beside_an_effect_are_as_uncertain_wherever_the_scans_are_placed) {
  const OfScans late(0.05);
  ASSERT_EQ(late.outcome.model.effects.size(), 1U);
  const double fitted =
      2.0 * std::sqrt(late.fit->result.covariance(vehicle::kLeftRadius, vehicle::kLeftRadius));
  for (const bool every_scan_placed : {true, false})
    EXPECT_NEAR(beyond(late.stated(every_scan_placed), fitted), kScale * kDiameter,
                0.02 * kScale * kDiameter);
}

}  // namespace
}  // namespace odomcalib::calib::report::findings_test
