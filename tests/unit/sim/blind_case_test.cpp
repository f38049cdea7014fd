#include "tests/sim/effects/blind_case.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim::blind_case_test {
namespace {

TEST(BlindCase, same_draw_same_case_and_other_number_other_case) {
  const BlindCase once = make_blind_case(42, 1), again = make_blind_case(42, 1),
                  other = make_blind_case(42, 2);
  EXPECT_EQ(answers_json({once.answer}), answers_json({again.answer}));
  ASSERT_EQ(once.run.recording.scans.size(), again.run.recording.scans.size());
  EXPECT_EQ(once.run.recording.scans.back().ranges, again.run.recording.scans.back().ranges);
  EXPECT_NE(answers_json({once.answer}), answers_json({other.answer}));
}

TEST(BlindCase, recordings_do_not_give_the_answer_away) {
  const BlindCase drawn = make_blind_case(42, 3);
  EXPECT_EQ(drawn.run.recording.name, "blind-42-3.jsonl.gz");
  EXPECT_EQ(drawn.run.recording.robot.robot_id, "blind-42-3");
  EXPECT_NE(drawn.run.recording.robot.track_width, drawn.answer.truth.track_width);
}

TEST(BlindCase, draws_many_effects_and_some_cases_without_and_keeps_clear_of_walls) {
  std::set<std::string> effects;
  for (unsigned number = 0; number < 12; ++number) {
    const BlindCase drawn = make_blind_case(9, number);
    EXPECT_GE(drawn.answer.least_clearance, 0.25) << "case " << number;
    EXPECT_GT(drawn.run.recording.scans.size(), 2000U);
    for (const BlindEffect& effect : drawn.answer.effects) {
      effects.insert(effect.name);
      const EffectKind* kind = find_effect(effect.name);
      ASSERT_NE(kind, nullptr);
      EXPECT_GE(effect.size, kind->smallest);
      EXPECT_LE(effect.size, kind->largest);
    }
  }
  EXPECT_GE(effects.size(), 6U);
}

TEST(BlindCase, without_effects_when_asked_for) {
  BlindOptions options;
  options.share_without_effect = 1.0;
  for (unsigned number = 0; number < 2; ++number)
    EXPECT_TRUE(make_blind_case(1, number, options).answer.effects.empty());
}

TEST(BlindCase, any_machine_means_other_lidars_and_encoders) {
  BlindOptions options;
  options.share_without_effect = 1.0;
  options.any_machine = true;
  std::set<std::size_t> beams;
  std::set<double> ticks;
  for (unsigned number = 0; number < 4; ++number) {
    const Recording recording = make_blind_case(3, number, options).run.recording;
    beams.insert(recording.scans.front().ranges.size());
    ticks.insert(recording.robot.ticks_per_rev);
  }
  EXPECT_GT(beams.size(), 1U);
  EXPECT_EQ(ticks.size(), 4U);
}

TEST(BlindCase, pairs_are_of_two_kinds_and_of_two_names) {
  BlindOptions options;
  options.share_without_effect = 0.0;
  options.effects = 2;
  options.only_catalogue = true;
  for (unsigned number = 0; number < 3; ++number) {
    const auto effects = make_blind_case(5, number, options).answer.effects;
    ASSERT_EQ(effects.size(), 2U);
    EXPECT_FALSE(effects[0].catalogue_name.empty());
    EXPECT_NE(effects[0].catalogue_name, effects[1].catalogue_name);
  }
}

TEST(BlindCase, the_proof_has_the_same_robot_and_other_data) {
  const BlindCase drawn = make_blind_case(42, 3);
  const BlindProof proof = make_blind_proof(42, 3);
  EXPECT_EQ(proof.fresh.truth.left_diameter, drawn.answer.truth.left_diameter);
  EXPECT_EQ(proof.twin.truth.track_width, drawn.answer.truth.track_width);
  EXPECT_NE(proof.fresh.recording.scans.front().ranges, drawn.run.recording.scans.front().ranges);
  EXPECT_EQ(proof.twin.recording.ticks.size(), drawn.run.recording.ticks.size());
}

}  // namespace
}  // namespace odomcalib::sim::blind_case_test
