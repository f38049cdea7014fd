// The way back through the history: one entry further each time, never to and fro.
#include "daemon/writeback/way_back.hpp"

#include <gtest/gtest.h>

namespace odomcalib::way_back_test {
namespace {

using Values = WayBack::Values;

const std::vector<drivers::StoredParameter> kSteps = {{"track_width", 0, 0.0, 1e-3}};

/// Write-backs of one drive, as a daemon would have entered them.
class Entered {
 public:
  void set(const Values& values, const std::string& outcome = "committed", const std::string& restores = "") {
    HistoryEntry entry;
    entry.id = "000" + std::to_string(entries_.size() + 1);
    entry.action = restores.empty() ? "apply" : "rollback";
    entry.outcome = outcome;
    entry.device = device;
    entry.origin.restores = restores;
    for (const auto& [name, value] : values) entry.before[name] = held_[name];
    entry.after = values;
    if (outcome == "committed")
      for (const auto& [name, value] : values) held_[name] = value;
    entries_.insert(entries_.begin(), entry);
  }
  /// Without an id.
  double roll_back() {
    const WayBack way(entries_, device);
    const HistoryEntry* const next = way.next();
    if (next == nullptr) return 0.0;
    const std::string id = next->id;
    set(way.before(*next), "committed", id);
    return held_["track_width"];
  }
  [[nodiscard]] const std::vector<HistoryEntry>& entries() const { return entries_; }
  std::string device = "a";

 private:
  Values held_{{"track_width", 0.40}, {"left_wheel_diameter", 0.15}};
  std::vector<HistoryEntry> entries_;
};

TEST(WayBack, goes_one_entry_further_each_time_and_ends_at_the_oldest) {
  Entered history;
  for (const double track : {0.41, 0.42, 0.43}) history.set({{"track_width", track}});
  history.set({{"track_width", 0.5}}, "rolled_back");
  EXPECT_EQ(history.roll_back(), 0.42);
  EXPECT_EQ(history.roll_back(), 0.41);
  EXPECT_EQ(history.roll_back(), 0.40);
  EXPECT_EQ(history.roll_back(), 0.0) << "there is nothing further back";
}

TEST(WayBack, goes_on_from_what_was_written_after_a_rollback) {
  Entered history;
  for (const double track : {0.41, 0.42}) history.set({{"track_width", track}});
  EXPECT_EQ(history.roll_back(), 0.41);
  history.set({{"track_width", 0.44}});
  EXPECT_EQ(history.roll_back(), 0.41);
  EXPECT_EQ(history.roll_back(), 0.40);
}

TEST(WayBack, brings_back_all_that_was_written_since) {
  Entered history;
  history.set({{"track_width", 0.41}});
  history.set({{"left_wheel_diameter", 0.16}});
  const WayBack way(history.entries(), "a");
  EXPECT_EQ(way.after(history.entries()[0]), (Values{{"track_width", 0.41}, {"left_wheel_diameter", 0.16}}));
  EXPECT_EQ(way.before(history.entries()[0]), (Values{{"track_width", 0.41}, {"left_wheel_diameter", 0.15}}));
  EXPECT_EQ(way.before(history.entries()[1]), (Values{{"track_width", 0.40}}));
}

TEST(WayBack, is_that_of_one_controller) {
  Entered history;
  history.set({{"track_width", 0.41}});
  history.device = "b";
  history.set({{"track_width", 0.45}});
  history.device = "";
  history.set({{"track_width", 0.46}});
  EXPECT_EQ(WayBack(history.entries(), "a").next()->id, "0003") << "of nobody: it may be";
  EXPECT_EQ(WayBack(history.entries(), "b").older_than("0003")->id, "0002");
  EXPECT_EQ(WayBack(history.entries(), "b").older_than("0002"), nullptr);
  EXPECT_EQ(WayBack(history.entries(), "").older_than("0002")->id, "0001");
}

TEST(WayBack, knows_what_was_verified_within_half_a_step) {
  Entered history;
  history.set({{"track_width", 0.41}});
  history.set({{"track_width", 0.42}});
  history.set({{"track_width", 0.48}}, "rolled_back");
  const WayBack way(history.entries(), "a");
  EXPECT_EQ(way.verified({{"track_width", 0.41}}, kSteps)->id, "0001");
  EXPECT_EQ(way.verified({{"track_width", 0.4105}}, kSteps)->id, "0001");
  EXPECT_EQ(way.verified({{"track_width", 0.4106}}, kSteps), nullptr);
  EXPECT_EQ(way.verified({{"track_width", 0.41001}}, {}), nullptr);
  EXPECT_EQ(way.verified({{"track_width", 0.48}}, kSteps), nullptr) << "it was not committed";
  EXPECT_EQ(way.verified({{"track_width", 0.40}}, kSteps), nullptr) << "found there, not written";
  EXPECT_EQ(way.verified({{"track_width", 0.41}, {"right_wheel_diameter", 0.15}}, kSteps), nullptr);
  EXPECT_EQ(way.verified({}, kSteps), nullptr);
}

TEST(WayBack, finds_what_came_after_an_entry) {
  Entered history;
  history.set({{"track_width", 0.41}});
  history.set({{"track_width", 0.5}}, "unknown");
  history.set({{"track_width", 0.42}});
  const WayBack way(history.entries(), "a");
  EXPECT_EQ(way.following(history.entries()[2])->id, "0003");
  EXPECT_EQ(way.following(history.entries()[0]), nullptr);
}

}  // namespace
}  // namespace odomcalib::way_back_test
