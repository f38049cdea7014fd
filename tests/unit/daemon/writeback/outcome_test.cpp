// The table of what each end of a write-back means.
#include "daemon/writeback/outcome.hpp"

#include <gtest/gtest.h>

#include <string>

namespace odomcalib::outcome_test {
namespace {

TEST(Endings, each_outcome_finds_its_own_row) {
  const auto all = endings();
  ASSERT_EQ(all.size(), static_cast<std::size_t>(WriteOutcome::unknown) + 1);
  for (const Ending& one : all) EXPECT_EQ(&ending_of(one.outcome), &one) << one.name;
  EXPECT_EQ(name_of(WriteOutcome::rolled_back), "rolled_back");
}

TEST(Endings, values_that_are_not_certain_are_never_what_was_asked_for) {
  for (const Ending& one : endings()) {
    EXPECT_TRUE(one.certain || !one.as_asked) << one.name;
    EXPECT_TRUE(one.certain || one.lasts) << one.name << ": the history has to say so";
  }
}

TEST(Endings, a_reading_alone_changes_nothing_and_answers_nobody) {
  for (const Ending& one : endings()) {
    if (one.of_a_write) continue;
    EXPECT_EQ(one.outcome, WriteOutcome::read);
    EXPECT_FALSE(one.as_asked || one.lasts || one.proof != nullptr);
  }
}

TEST(Endings, values_that_wait_for_their_proof_do_not_last) {
  for (const Ending& one : endings())
    EXPECT_EQ(one.of_a_write && !one.lasts, one.outcome == WriteOutcome::proving) << one.name;
}

}  // namespace
}  // namespace odomcalib::outcome_test
