// Write-backs of the history on a report: which are of the calibration's robot, and what is said of them.
#include "daemon/cli/write_backs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/writeback/history.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::cli::write_backs_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Calibration example() {
  Calibration calibration;
  calibration.parameters = {{"track_width", {0.41, 2e-4, "m"}}};
  calibration.verdict = Verdict::accepted;
  return calibration;
}

/// Written and proven, taken back by hand; the third is of another robot.
std::vector<WriteBack> history_of(const Calibration& calibration) {
  const auto bodies = nlohmann::ordered_json::parse(R"([
    {"id":"0003","time":1795953660000000,"action":"apply","outcome":"committed","user":null,"device":"0x1/0x2/9",
     "robot_id":"carrier-18","calibration_sha256":"","proven":false,"before":{},"after":{"track_width":0.5}},
    {"id":"0002","time":1795953600000000,"action":"rollback","outcome":"committed","user":1000,"user_name":"ada",
     "device":"0x1/0x2/3","robot_id":"","calibration_sha256":"","restores":"0001","proven":false,
     "before":{"track_width":0.41},"after":{"track_width":0.4}},
    {"id":"0001","time":1795953540000000,"action":"apply","outcome":"committed","user":1001,"device":"0x1/0x2/3",
     "robot_id":"","calibration_sha256":"","proven":true,"before":{"track_width":0.4},"after":{"track_width":0.41},
     "trial":{"before":{"straight_metre_length":0.0204,"straight_metre_heading":0.001,"full_turn_heading":0.21},
              "after":{"straight_metre_length":0.0011,"straight_metre_heading":0.001,"full_turn_heading":0.002}}}])");
  std::vector<WriteBack> entries;
  for (const auto& body : bodies) entries.push_back(write_back_from(body).value());
  entries[2].entry.origin.calibration_sha256 = digest_in_history(calibration);
  return entries;
}

// The rollback is known by the controller of the entry that wrote the calibration.
TEST(WriteBacks, entries_of_a_robot_are_known_by_calibration_robot_and_controller) {
  Calibration calibration = example();
  const auto entries = history_of(calibration);
  const auto ids = [&](const Calibration& of) {
    std::string text;
    for (const WriteBack& one : entries_of_robot(entries, of)) text += one.entry.id + " ";
    return text;
  };
  EXPECT_EQ(ids(calibration), "0002 0001 ");
  calibration.settings.emplace().note = "another";
  EXPECT_EQ(ids(calibration), "") << "neither the calibration nor its robot is known";
  calibration.robot.robot_id = "carrier-18";
  EXPECT_EQ(ids(calibration), "0003 ");
  calibration.robot.controller_id = "0x1/0x2/3";
  EXPECT_EQ(ids(calibration), "0003 0002 0001 ");
  calibration.robot = {};
  calibration.robot.controller_id = "0x1/0x2/9";
  calibration.robot.robot_id = "carrier-19";
  EXPECT_EQ(ids(calibration), "") << "the controller is in another robot";
}

TEST(WriteBacks, page_and_text_say_who_wrote_what_and_which_drive_proved_it) {
  const Calibration calibration = example();
  const auto sections = write_back_sections(entries_of_robot(history_of(calibration), calibration),
                                            digest_in_history(calibration));
  const std::string text = to_text(describe(calibration, sections), true, 200);
  const std::string page = report_page(calibration, sections);
  for (const char* said :
       {"Written to the controller",
        "This calibration was written on 2026-11-29 11:59 UTC by (1001), entry 0001: committed, proven.",
        "Other values were written since: 0002.", "ada (1000)", "rollback before 0001",
        "Trials: ", "straight metre: length", "20.40", "1.10", "12.03"}) {
    EXPECT_THAT(text, HasSubstr(said));
    EXPECT_THAT(page, HasSubstr(said));
  }
  EXPECT_THAT(page, HasSubstr("<summary>Written to the controller</summary>"));
  EXPECT_THAT(page, HasSubstr("400.000 -&gt; 410.000"));
  EXPECT_THAT(page.substr(0, page.find("<details>")), Not(HasSubstr("ada")));
}

TEST(WriteBacks, what_was_not_committed_or_proven_is_said_so) {
  const Calibration calibration = example();
  auto own = history_of(calibration)[2];
  const auto lines = [&] {
    return to_text({"", write_back_sections({own}, digest_in_history(calibration))});
  };
  own.entry.outcome = "rolled_back";
  EXPECT_THAT(lines(),
              HasSubstr("was to be written on 2026-11-29 11:59 UTC by (1001), entry 0001: rolled back."));
  own.entry.outcome = "committed";
  own.entry.origin.proven = false;
  own.entry.origin.trial = {};
  EXPECT_THAT(lines(), HasSubstr("No drive compared odometry before and after"));
  EXPECT_THAT(lines(), Not(HasSubstr("Trials")));
  own.entry.origin.calibration_sha256 = "";
  EXPECT_THAT(lines(), HasSubstr("No entry names this calibration"));
}

TEST(WriteBacks, a_report_without_entries_has_no_section_of_them) {
  EXPECT_TRUE(write_back_sections({}, "").empty());
  EXPECT_THAT(report_page(example()), Not(HasSubstr("Written to the controller")));
  EXPECT_EQ(report_page(example()), report_page(example(), {}));
}

class HistoryFile : public testing::Test {
 protected:
  [[nodiscard]] std::string read(const std::string& text) const {
    std::ofstream(folder_ / "history.json") << text;
    const auto entries = read_history(folder_ / "history.json");
    if (!entries) return entries.error().text();
    std::string all;
    for (const WriteBack& one : entries.value()) all += to_json(one.entry, false) + one.user_name;
    return all;
  }
  TemporaryFolder folder_;
};

TEST_F(HistoryFile, is_what_history_prints_or_a_state_folder) {
  HistoryEntry entry;
  entry.id = "0001";
  entry.action = "apply";
  entry.outcome = "committed";
  entry.before = entry.after = {{"track_width", 0.4}};
  entry.origin.trial.before = DriveErrors{0.02, 0.0, 0.1};
  ASSERT_TRUE(History(folder_ / "history").write(entry).ok());
  const auto of_folder = read_history(folder_.path());
  ASSERT_TRUE(of_folder.ok());
  ASSERT_EQ(of_folder.value().size(), 1U);
  EXPECT_EQ(to_json(of_folder.value().front().entry, false), to_json(entry, false));
  EXPECT_EQ(
      read(R"({"format":"odomcalib-history/1","calibrations":"","entries":[)" + to_json(entry, false) + "]}"),
      to_json(entry, false));
  EXPECT_EQ(read(R"({"entries":[]})"), "");
}

TEST_F(HistoryFile, says_what_is_wrong_with_it) {
  for (const char* none : {"", "[]", "{}", R"({"entries":{}})", R"({"format":"odomcalib-calibration/1"})"})
    EXPECT_THAT(read(none), HasSubstr("is no history of write-backs")) << none;
  for (const char* none :
       {R"({"entries":[1]})", R"({"entries":[{}]})",
        R"({"entries":[{"id":1,"time":1,"action":"","outcome":"","before":{},"after":{}}]})",
        R"({"entries":[{"id":"1","time":1,"action":"","outcome":"","before":{"a":null},"after":{}}]})"})
    EXPECT_THAT(read(none), HasSubstr("\"entries[0]\" is no write-back")) << none;
  EXPECT_THAT(read_history(folder_.path()).error().text(), HasSubstr("cannot read the history"));
  EXPECT_THAT(read_history(folder_ / "absent").error().text(), HasSubstr("absent"));
}

}  // namespace
}  // namespace odomcalib::cli::write_backs_test
