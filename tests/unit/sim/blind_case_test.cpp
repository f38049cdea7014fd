#include "tests/sim/effects/blind_case.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/sim/effects/effect.hpp"

namespace odomcalib::sim {
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
    effects.insert(drawn.answer.effect);
    EXPECT_GE(drawn.answer.least_clearance, 0.25) << "case " << number;
    EXPECT_GT(drawn.run.recording.scans.size(), 2000U);
    if (drawn.answer.effect.empty()) continue;
    const EffectKind* kind = find_effect(drawn.answer.effect);
    ASSERT_NE(kind, nullptr);
    EXPECT_GE(drawn.answer.size, kind->smallest);
    EXPECT_LE(drawn.answer.size, kind->largest);
  }
  EXPECT_GE(effects.size(), 6U);
}

TEST(BlindCase, without_effects_when_asked_for) {
  BlindOptions options;
  options.share_without_effect = 1.0;
  for (unsigned number = 0; number < 2; ++number)
    EXPECT_TRUE(make_blind_case(1, number, options).answer.effect.empty());
}

}  // namespace
}  // namespace odomcalib::sim
