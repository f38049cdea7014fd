// Recordings of robots that nobody has seen, each with one fault of the table in a drawn form, of a drawn
// size and from a drawn moment on: half of them so small that they do no harm. And recordings without a
// fault.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "calib/ingest/checks.hpp"
#include "calib/solve.hpp"
#include "tests/integration/recording_faults.hpp"
#include "tests/sim/world/simulate.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::front_door_campaign_test {
namespace {

using calib::ingest::Answer;
using recording_faults::Form;

/// Runs of a full campaign: ODOMCALIB_CAMPAIGN; the suite takes a few.
std::size_t runs(std::size_t few) {
  const char* text = std::getenv("ODOMCALIB_CAMPAIGN");
  return text == nullptr ? few : static_cast<std::size_t>(std::atoi(text));
}

std::uint64_t first_seed() {
  const char* text = std::getenv("ODOMCALIB_TEST_SEED");
  return text == nullptr ? 5000 : static_cast<std::uint64_t>(std::atoll(text));
}

sim::SimulatedRun drive(std::uint64_t seed) {
  sim::SimulationConfig config = sim::standard_config(seed);
  config.duration = 110.0;
  return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
}

struct Case {
  const calib::ingest::Fault* fault = nullptr;
  Form form = Form::ticks;
  recording_faults::Draw draw;
};

/// One of the cells whose fault the form can have, and that JSON Lines can hold.
Case drawn(std::mt19937_64& engine) {
  std::vector<Case> cells;
  for (const auto& fault : calib::ingest::faults())
    for (std::size_t k = 0; k < calib::ingest::kForms; ++k) {
      const auto form = static_cast<Form>(k);
      const bool by_name = std::string(fault.name) == "several_sources" && form != Form::scan;
      if (fault.cells.at(k).answer != Answer::cannot && !by_name) cells.push_back({&fault, form, {}});
    }
  std::uniform_int_distribution<std::size_t> any(0, cells.size() - 1);
  std::uniform_real_distribution<double> share(0.0, 1.0), middle(0.2, 0.8);
  Case one = cells[any(engine)];
  one.draw = {share(engine), middle(engine)};
  return one;
}

Calibration solved(const Recording& recording, std::string& text) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "drive.jsonl";
  EXPECT_TRUE(write_recording_jsonl(recording, path));
  const auto read = read_recording(path);
  if (!read) {
    text = read.error().text();
    return {};
  }
  Calibration calibration = calib::solve({&read.value(), 1}, {});
  for (const std::string& reason : calibration.reasons) text += reason + " | ";
  return calibration;
}

/// Stated deviations by which the worst of the three lengths is off.
double worst_length(const Calibration& calibration, const sim::Geometry& truth) {
  double worst = 0.0;
  for (const auto& [name, quantity] : calibration.parameters) {
    const double value = name == "left_wheel_diameter"    ? truth.left_diameter
                         : name == "right_wheel_diameter" ? truth.right_diameter
                         : name == "track_width"          ? truth.track_width
                                                          : quantity.value;
    if (quantity.std > 0.0) worst = std::max(worst, std::abs(quantity.value - value) / quantity.std);
  }
  return worst;
}

const char* word_of(Verdict verdict) {
  return verdict == Verdict::refused ? "refused" : verdict == Verdict::accepted ? "accepted" : "warnings";
}

TEST(FrontDoorCampaign, accepts_no_recording_with_a_fault_whose_lengths_are_off) {
  const std::uint64_t seed = first_seed();
  std::size_t accepted = 0, off = 0;
  for (std::uint64_t k = seed; k < seed + runs(4); ++k) {
    std::mt19937_64 engine(k);
    const Case one = drawn(engine);
    const sim::SimulatedRun run = drive(k);
    Recording recording = recording_faults::told_as(run, one.form);
    recording_faults::makers().at(one.fault->name)(recording, one.form, one.draw);
    std::string text;
    const Calibration calibration = solved(recording, text);
    const double worst = worst_length(calibration, run.truth);
    const bool is_accepted = calibration.verdict != Verdict::refused;
    accepted += is_accepted ? 1 : 0;
    off += is_accepted && worst > 4.0 ? 1 : 0;
    std::cout << "seed " << k << ": " << one.fault->name << " of " << name_of(one.form) << ", size "
              << one.draw.size << ", " << word_of(calibration.verdict) << ", " << worst << " deviations; "
              << text.substr(0, 160) << "\n";
    EXPECT_FALSE(is_accepted && worst > 4.0) << "seed " << k << ": " << text;
  }
  std::cout << "of " << runs(4) << " with a fault " << accepted << " accepted, " << off << " of them off\n";
}

TEST(FrontDoorCampaign, refuses_and_accuses_no_sound_recording) {
  const std::uint64_t seed = first_seed() + 100'000;
  std::size_t refused = 0, spoken = 0;
  for (std::uint64_t k = seed; k < seed + runs(3) * 2 / 3; ++k) {
    std::mt19937_64 engine(k);
    const auto form =
        static_cast<Form>(std::uniform_int_distribution<int>(0, calib::ingest::kForms - 1)(engine));
    std::string text;
    const Calibration calibration = solved(recording_faults::told_as(drive(k), form), text);
    const bool is_refused = calibration.verdict == Verdict::refused;
    refused += is_refused ? 1 : 0;
    spoken += calibration.repairs.empty() ? 0 : 1;
    if (!text.empty())
      std::cout << "seed " << k << ", " << name_of(form) << ": " << text.substr(0, 160) << "\n";
    EXPECT_FALSE(is_refused) << "seed " << k << ", " << name_of(form) << ": " << text;
    EXPECT_TRUE(calibration.repairs.empty()) << "seed " << k << ", " << name_of(form);
  }
  std::cout << "of " << runs(3) * 2 / 3 << " without " << refused << " refused, " << spoken << " put right\n";
}

}  // namespace
}  // namespace odomcalib::front_door_campaign_test
