// What is on the disk: journal, history, the calibration in force.
#include <sys/resource.h>
#include <zlib.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "daemon/writeback/calibration_in_force.hpp"
#include "daemon/writeback/history.hpp"
#include "proto/file_bytes.hpp"
#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::journal_test {
namespace {

TEST(Journal, keeps_records_and_drops_a_torn_end) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  {
    auto journal = value_of(Journal::open(path));
    JournalRecord record;
    record.state = JournalState::write;
    record.before = {{"track_width", 0.4}};
    ASSERT_TRUE(journal.append(record).ok());
    record.state = JournalState::store_begin;
    ASSERT_TRUE(journal.append(record).ok());
  }
  const auto size = std::filesystem::file_size(path);
  for (std::uintmax_t cut = size - 1; cut > size / 2 + 4; --cut) {
    std::filesystem::resize_file(path, cut);
    auto journal = value_of(Journal::open(path));
    ASSERT_TRUE(journal.last().has_value()) << cut;
    EXPECT_EQ(journal.last()->state, JournalState::write) << cut;
    EXPECT_EQ(journal.last()->before.at("track_width"), 0.4);
  }
}

TEST(Journal, that_is_read_only_is_read_and_never_written) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  {
    auto journal = value_of(Journal::open(path));
    JournalRecord record;
    record.state = JournalState::store_begin;
    ASSERT_TRUE(journal.append(record).ok());
  }
  const auto size = std::filesystem::file_size(path);
  auto journal = value_of(Journal::open_read_only(path));
  ASSERT_TRUE(journal.unfinished()) << "motion stays forbidden";
  EXPECT_EQ(journal.append({}).error().code, ErrorCode::io);
  EXPECT_EQ(std::filesystem::file_size(path), size);
  EXPECT_TRUE(Journal::open_read_only(folder / "absent").ok());
  EXPECT_FALSE(std::filesystem::exists(folder / "absent"));
  EXPECT_FALSE(Journal::open_read_only(folder).ok()) << "a folder";
}

std::string checked(const std::string& body) {
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  std::array<char, 10> text{};
  std::snprintf(text.data(), text.size(), "%08lx ", crc);
  return text.data() + body;
}

TEST(Journal, rejects_every_flipped_bit) {
  JournalRecord record;
  record.after = {{"track_width", 0.4}};
  std::string line = to_line(record);
  line.pop_back();
  ASSERT_TRUE(from_line(line).has_value());
  for (std::size_t i = 0; i < line.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = line;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      EXPECT_FALSE(from_line(damaged).has_value()) << i << " " << bit;
    }
}

TEST(Journal, records_of_earlier_versions_are_read) {
  const std::string body =
      R"({"after":{"track_width":0.41},"before":{"track_width":0.4},"label":"apply","monotonic":1.5,"seq":3,)"
      R"("state":"store_begin","wall_us":7})";
  const auto record = from_line(checked(body));
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->seq, 3U);
  EXPECT_EQ(record->device, "");
  EXPECT_TRUE(record->store_begun);
}

TEST(Journal, numbers_that_no_journal_writes_are_damage) {
  const std::string good = to_line(record_of(JournalState::write));
  ASSERT_TRUE(from_line(good.substr(0, good.size() - 1)));
  for (const char* number : {"1e300", "-1", "0.5", "\"7\"", "null"}) {
    for (const char* member : {"\"seq\":", "\"wall_us\":"}) {
      std::string text = good.substr(9, good.size() - 10);
      const std::size_t at = text.find(member) + std::string(member).size();
      if (number == std::string("-1") && member == std::string("\"wall_us\":")) continue;  // before 1970
      text.replace(at, text.find_first_of(",}", at) - at, number);
      EXPECT_FALSE(from_line(checked(text))) << text;
    }
  }
}

TEST(Journal, keeps_who_holds_the_values_and_what_goes_with_them) {
  JournalRecord record = record_of(JournalState::begin);
  record.device = "0xfee/0xd15/1 + 0xfee/0xd15/2";
  record.calibration = "none";
  record.store_begun = true;
  std::string line = to_line(record);
  line.pop_back();
  const auto read = from_line(line);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->device, record.device);
  EXPECT_EQ(read->calibration, "none");
  EXPECT_TRUE(read->store_begun);
}

// No file of this process grows beyond so many bytes: what a full disk does.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(Journal, a_record_for_which_the_disk_was_full_does_not_spoil_the_next_one) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  auto journal = value_of(Journal::open(path));
  ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
  const auto size = std::filesystem::file_size(path);
  {
    const FileLimit full(size + 20);
    EXPECT_FALSE(journal.append(record_of(JournalState::write)).ok());
    EXPECT_EQ(std::filesystem::file_size(path), size);
    EXPECT_EQ(journal.last()->state, JournalState::begin);
  }
  ASSERT_TRUE(journal.append(record_of(JournalState::rollback)).ok());
  const auto again = Journal::open(path);
  ASSERT_TRUE(again.ok() && again.value().last());
  EXPECT_EQ(again.value().last()->state, JournalState::rollback);
  EXPECT_EQ(again.value().last()->seq, 2U);
}

TEST(Journal, is_rotated_between_write_backs_and_never_within_one) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  auto journal = value_of(Journal::open(path));
  JournalRecord bulky = record_of(JournalState::needs_operator);
  bulky.label = std::string(Journal::kRotateAt, 'x');
  ASSERT_TRUE(journal.append(bulky).ok());
  ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
  EXPECT_GT(std::filesystem::file_size(path), Journal::kRotateAt);
  ASSERT_TRUE(journal.append(record_of(JournalState::commit)).ok());
  ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
  EXPECT_LT(std::filesystem::file_size(path), 2000U);
  EXPECT_GT(std::filesystem::file_size(path.string() + ".1"), Journal::kRotateAt);
  EXPECT_EQ(Journal::open(path).value().last()->state, JournalState::begin);
}

TEST(CalibrationInForce, is_the_announced_one_once_it_is_settled) {
  const TemporaryFolder folder;
  const CalibrationInForce calibrations(folder);
  const auto first = value_of(calibrations.announce("first", ""));
  EXPECT_FALSE(std::filesystem::exists(calibrations.path()));
  ASSERT_TRUE(calibrations.settle(first).ok());
  EXPECT_EQ(read_file_bytes(calibrations.path()).value(), "first");
  // What the journal still needs is kept while others are announced and forgotten.
  const auto second = calibrations.announce("second", first);
  const auto third = calibrations.announce("third", first);
  EXPECT_EQ(calibrations.announced(first), "first");
  EXPECT_FALSE(calibrations.announced(second.value()));
  ASSERT_TRUE(calibrations.settle("").ok());
  EXPECT_EQ(read_file_bytes(calibrations.path()).value(), "first");
  ASSERT_TRUE(calibrations.settle(third.value()).ok());
  EXPECT_EQ(read_file_bytes(calibrations.path()).value(), "third");
  EXPECT_FALSE(calibrations.settle(second.value()).ok());
  ASSERT_TRUE(calibrations.settle(calibrations.announce(std::nullopt, "").value()).ok());
  EXPECT_FALSE(std::filesystem::exists(calibrations.path()));
}

TEST(CalibrationInForce, a_damaged_announcement_is_not_put_in_force) {
  const TemporaryFolder folder;
  const CalibrationInForce calibrations(folder);
  const std::string id = calibrations.announce("first", "").value();
  std::ofstream(folder / "announced" / (id + ".json")) << "other";
  EXPECT_FALSE(calibrations.settle(id).ok());
  EXPECT_FALSE(std::filesystem::exists(calibrations.path()));
}

void add(History& history, HistoryEntry entry) {
  entry = history.numbered(std::move(entry));
  ASSERT_TRUE(history.write(entry).ok());
  history.keep(std::move(entry));
}

TEST(History, finds_the_newest_that_was_committed_and_remembers_the_device) {
  const TemporaryFolder folder;
  History history(folder / "history");
  EXPECT_FALSE(history.newest_committed());
  for (const char* outcome : {"committed", "committed", "rolled_back", "unknown"}) {
    HistoryEntry entry;
    entry.outcome = outcome;
    entry.device = "0xfee/0xd15/1";
    add(history, entry);
  }
  ASSERT_TRUE(history.newest_committed());
  EXPECT_EQ(history.newest_committed()->id, "0002");
  EXPECT_EQ(history.newest_committed()->device, "0xfee/0xd15/1");
}

class FullHistory : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 60; ++i) {
      HistoryEntry entry;
      entry.time = i;
      entry.action = "apply";
      entry.calibration = R"({"format":"x"})";
      add(history_, entry);
    }
  }
  static void expect_newest_fifty(const History& history) {
    const auto& entries = history.entries();
    ASSERT_EQ(entries.size(), History::kKept);
    EXPECT_EQ(entries.front().time, 59);
    EXPECT_EQ(entries.front().id, "0060");
    EXPECT_EQ(entries.back().id, "0011");
    ASSERT_TRUE(history.find("0060").has_value());
    EXPECT_EQ(*history.find("0060")->calibration, R"({"format":"x"})");
    EXPECT_FALSE(history.find("0001").has_value());
  }
  const TemporaryFolder folder_;
  History history_{folder_ / "history"};
};

TEST_F(FullHistory, keeps_the_newest_fifty_newest_first) {
  expect_newest_fifty(history_);
  expect_newest_fifty(History(folder_ / "history"));  // what the disk has
}

TEST_F(FullHistory, goes_on_counting_behind_an_entry_that_cannot_be_read) {
  std::ofstream(folder_ / "history" / "0061.json") << "{";
  const History again(folder_ / "history");
  EXPECT_EQ(again.entries().front().id, "0060");
  EXPECT_EQ(again.numbered({}).id, "0062");
}

TEST_F(FullHistory, answers_without_its_disk) {
  std::filesystem::remove_all(folder_);
  expect_newest_fifty(history_);
}

}  // namespace
}  // namespace odomcalib::journal_test
