// Files on the disk: journal, history, the calibration in force.
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
  const auto size = to_line(*journal.last()).size();
  {
    const FileLimit full(size + 20);  // less than what is reserved
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

TEST(Journal, a_disk_that_is_full_is_noticed_before_anything_begins) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  auto journal = value_of(Journal::open(path));
  const FileLimit full(Journal::kReserved / 2);
  EXPECT_FALSE(journal.append(record_of(JournalState::begin)).ok());
  EXPECT_FALSE(journal.last());
  EXPECT_EQ(std::filesystem::file_size(path), 0U);
}

/// States in the file, and whether nothing but zeros is behind the lines.
std::pair<std::vector<JournalState>, bool> content_of(const std::filesystem::path& path) {
  const std::string text = read_file_bytes(path).value();
  std::vector<JournalState> states;
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
    states.push_back(from_line(text.substr(begin, end - begin)).value().state);
  return {states, text.find_first_not_of('\0', begin) == std::string::npos};
}

// Space that a write-back needs to its end is there when it begins, and a crash does not give it away.
TEST(Journal, has_space_for_a_whole_write_back_however_full_the_disk_gets_meanwhile) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  for (const bool crash : {false, true}) {
    auto journal = value_of(Journal::open(path));
    ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
    const auto size = std::filesystem::file_size(path);
    EXPECT_GE(size, Journal::kReserved);
    EXPECT_TRUE(content_of(path).second);
    auto next = crash ? value_of(Journal::open(path)) : std::move(journal);
    EXPECT_EQ(std::filesystem::file_size(path), size);
    const FileLimit full(size);
    for (const auto state : {JournalState::write, JournalState::readback_ok, JournalState::proof_ok,
                             JournalState::store_begin, JournalState::store_ok, JournalState::rollback,
                             JournalState::needs_operator, JournalState::rollback, JournalState::rolled_back})
      ASSERT_TRUE(next.append(record_of(state)).ok()) << name_of(state);
    EXPECT_LT(std::filesystem::file_size(path), size) << "what is not needed is given back at the end";
    EXPECT_EQ(content_of(path).first.back(), JournalState::rolled_back);
  }
  EXPECT_EQ(content_of(path).first.size(), 20U);
}

TEST(Journal, a_torn_record_in_the_reserved_space_is_written_over) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  {
    auto journal = value_of(Journal::open(path));
    ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
    JournalRecord longer = record_of(JournalState::write);
    longer.label = std::string(500, 'x');
    ASSERT_TRUE(journal.append(longer).ok());
  }
  std::string text = read_file_bytes(path).value();
  text[text.rfind('\n')] = '\0';
  std::ofstream(path, std::ios::binary) << text;
  auto journal = value_of(Journal::open(path));
  EXPECT_EQ(journal.last()->state, JournalState::begin);
  ASSERT_TRUE(journal.append(record_of(JournalState::rollback)).ok());
  EXPECT_EQ(Journal::open(path).value().last()->state, JournalState::rollback);
  ASSERT_TRUE(journal.append(record_of(JournalState::rolled_back)).ok());
  EXPECT_EQ(
      content_of(path),
      (std::pair{std::vector{JournalState::begin, JournalState::rollback, JournalState::rolled_back}, true}));
}

TEST(Journal, that_a_crash_within_its_rotation_has_left_alone_is_read) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  {
    auto journal = value_of(Journal::open(path));
    ASSERT_TRUE(journal.append(record_of(JournalState::commit)).ok());
  }
  std::filesystem::rename(path, path.string() + ".1");
  for (const bool reading_only : {true, false}) {
    const auto journal = value_of(reading_only ? Journal::open_read_only(path) : Journal::open(path));
    ASSERT_TRUE(journal.last()) << reading_only;
    EXPECT_EQ(journal.last()->state, JournalState::commit);
    EXPECT_EQ(journal.ends().size(), 1U);
    EXPECT_TRUE(journal.damage().empty());
    EXPECT_EQ(std::filesystem::exists(path), !reading_only);
  }
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(Journal, counts_the_lines_that_it_cannot_read) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  const std::string good = to_line(record_of(JournalState::begin));
  std::string flipped = good;
  flipped[20] = static_cast<char>(flipped[20] ^ 1);
  write_text(path.string() + ".1", flipped);
  write_text(path, good + flipped + good + checked(R"({"seq":1,"state":"of_tomorrow"})") + "\n\n" +
                       to_line(record_of(JournalState::commit)));
  for (const bool reading_only : {true, false}) {
    const auto journal = value_of(reading_only ? Journal::open_read_only(path) : Journal::open(path));
    EXPECT_EQ(journal.last()->state, JournalState::commit);
    ASSERT_EQ(journal.damage().size(), 2U);
    EXPECT_EQ(journal.damage()[0].lines, 1U);
    EXPECT_EQ(journal.damage()[0].last_line, 1U);
    EXPECT_EQ(journal.damage()[1].lines, 3U);
    EXPECT_EQ(journal.damage()[1].last_line, 5U);
    EXPECT_EQ(journal.damage()[1].bytes, 0U);
    EXPECT_EQ(to_text(journal.damage()[0]).find(path.string() + ".1: line 1 cannot be read; "), 0U);
    EXPECT_EQ(
        to_text(journal.damage()[1]).find(path.string() + ": 3 lines cannot be read, the last is line 5; "),
        0U);
  }
}

// A record that was being written when the power failed is no damage, wherever it is cut off.
TEST(Journal, a_torn_end_is_no_damage) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  const std::string good = to_line(record_of(JournalState::begin));
  for (std::size_t kept = 0; kept < good.size(); ++kept) {
    const std::string zeros(Journal::kReserved - kept, '\0');
    for (const std::string& rest : {good.substr(0, kept), good.substr(0, kept) + zeros,
                                    std::string(kept, '\0') + good.substr(kept, good.size() - kept - 1)}) {
      write_text(path, good + rest);
      const auto journal = value_of(Journal::open_read_only(path));
      ASSERT_TRUE(journal.damage().empty()) << kept << " " << to_text(journal.damage().front());
    }
  }
}

TEST(Journal, says_how_many_bytes_behind_its_lines_are_no_record) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  const std::string good = to_line(record_of(JournalState::commit));
  for (const std::string& rest : {std::string(3000, 'x'), std::string("[robot]"), good.substr(0, 8) + "{",
                                  good.substr(0, 9) + "[", std::string(Journal::kReserved + 1, '\0')}) {
    for (const std::string& lines : {std::string(), good}) {
      write_text(path, lines + rest);
      const auto journal = value_of(Journal::open(path));
      ASSERT_EQ(journal.damage().size(), 1U);
      EXPECT_EQ(journal.damage()[0].lines, 0U);
      EXPECT_EQ(journal.damage()[0].bytes, rest.size());
      EXPECT_EQ(to_text(journal.damage()[0])
                    .find(path.string() + ": " + std::to_string(rest.size()) +
                          " bytes behind the last line are no record; "),
                0U)
          << to_text(journal.damage()[0]);
      EXPECT_EQ(std::filesystem::file_size(path), lines.size());
    }
  }
}

TEST(Journal, says_that_the_file_before_it_cannot_be_read) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  EXPECT_TRUE(value_of(Journal::open(path)).damage().empty()) << "there is none";
  std::filesystem::create_directory(path.string() + ".1");
  const auto journal = value_of(Journal::open(path));
  ASSERT_EQ(journal.damage().size(), 1U);
  EXPECT_NE(to_text(journal.damage()[0]).find("journal.1: is a folder; "), std::string::npos);
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
  EXPECT_LT(std::filesystem::file_size(path), 2000U + Journal::kReserved);
  EXPECT_GT(std::filesystem::file_size(path.string() + ".1"), Journal::kRotateAt);
  EXPECT_EQ(Journal::open(path).value().last()->state, JournalState::begin);
  // The numbers go on, also where the power fails right after the rotation.
  std::filesystem::resize_file(path, 0);
  EXPECT_EQ(Journal::open(path).value().last()->seq, 3U);
  EXPECT_EQ(Journal::open(path).value().ends().back().state, JournalState::commit);
}

TEST(Journal, is_rotated_from_its_size_on) {
  for (const std::size_t short_by : {0U, 1U}) {
    const TemporaryFolder folder;
    auto journal = value_of(Journal::open(folder / "journal"));
    JournalRecord bare = record_of(JournalState::commit);
    bare.seq = 1;
    bare.label.clear();
    bare.label = std::string(Journal::kRotateAt - short_by - to_line(bare).size(), 'x');
    ASSERT_TRUE(journal.append(bare).ok());
    ASSERT_EQ(std::filesystem::file_size(folder / "journal"), Journal::kRotateAt - short_by);
    ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
    EXPECT_EQ(std::filesystem::exists(folder / "journal.1"), short_by == 0) << short_by;
  }
}

// No file can be opened: the one that was put away comes back, and is written as soon as there is one.
TEST(Journal, that_cannot_be_rotated_stays_as_it_was) {
  const TemporaryFolder folder;
  const auto path = folder / "journal";
  auto journal = value_of(Journal::open(path));
  JournalRecord bulky = record_of(JournalState::commit);
  bulky.label = std::string(Journal::kRotateAt, 'x');
  ASSERT_TRUE(journal.append(bulky).ok());
  const auto size = std::filesystem::file_size(path);
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none{0, before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  EXPECT_FALSE(journal.append(record_of(JournalState::begin)).ok());
  setrlimit(RLIMIT_NOFILE, &before);
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_EQ(std::filesystem::file_size(path), size);
  EXPECT_EQ(Journal::open(path).value().last()->state, JournalState::commit);
  ASSERT_TRUE(journal.append(record_of(JournalState::begin)).ok());
  EXPECT_EQ(Journal::open(path).value().last()->state, JournalState::begin);
  EXPECT_EQ(std::filesystem::file_size(folder / "journal.1"), size);
}

TEST(CalibrationInForce, is_the_announced_one_once_it_is_settled) {
  const TemporaryFolder folder;
  const CalibrationInForce calibrations(folder);
  const auto first = value_of(calibrations.announce("first", ""));
  EXPECT_FALSE(std::filesystem::exists(calibrations.path()));
  ASSERT_TRUE(calibrations.settle(first).ok());
  EXPECT_EQ(read_file_bytes(calibrations.path()).value(), "first");
  // A calibration that the journal still needs is kept while others are announced and forgotten.
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

Provenance some_provenance() {
  Provenance origin;
  origin.entry = "0007";
  origin.user = 1000;
  origin.nominal = {{"track_width", 0.4}};
  origin.nominal_from = {{"track_width", "robot.track_width of odomcalib.toml"}};
  origin.restores = "0003";
  origin.proven = true;
  origin.robot_id = "carrier-17";
  origin.calibration_sha256 = sha256_hex("a calibration");
  origin.trial = {DriveErrors{0.02, 0.01, 0.1}, std::nullopt};
  return origin;
}

TEST(Journal, keeps_whose_wish_it_was_and_what_its_values_were_held_to) {
  JournalRecord record = record_of(JournalState::commit);
  record.origin = some_provenance();
  std::string line = to_line(record);
  line.pop_back();
  EXPECT_EQ(from_line(line).value().origin, some_provenance());
}

// The history is what the journal says: an entry that is missing, or that tells of an earlier end, is made of
// it.
TEST(History, is_made_of_the_journal_where_it_lacks_an_entry) {
  const TemporaryFolder folder;
  History history(folder / "history");
  std::vector<JournalRecord> ends;
  for (const auto state : {JournalState::commit, JournalState::needs_operator, JournalState::rolled_back}) {
    ends.push_back(record_of(state));
    ends.back().origin = some_provenance();
    ends.back().origin.entry = state == JournalState::commit ? "0001" : "0002";
  }
  ends.push_back(record_of(JournalState::commit));  // of an earlier version
  ASSERT_TRUE(history.write(entry_of(ends[1])).ok());
  history.keep(entry_of(ends[1]));
  const auto missing = history.missing(ends);
  ASSERT_EQ(missing.size(), 2U) << "0001, and 0002 tells of an earlier end";
  for (const auto& end : missing) {
    ASSERT_TRUE(history.write(entry_of(end)).ok());
    history.keep(entry_of(end));
  }
  EXPECT_TRUE(history.missing(ends).empty());
  const History again(folder / "history");
  EXPECT_TRUE(again.missing(ends).empty());
  ASSERT_EQ(again.entries().size(), 2U);
  EXPECT_EQ(again.entries()[0].outcome, "rolled_back");
  EXPECT_EQ(again.entries()[1].outcome, "committed");
  EXPECT_EQ(again.entries()[1].after, kNew);
  EXPECT_EQ(again.entries()[1].origin.user, 1000U);
  EXPECT_EQ(again.entries()[1].origin.restores, "0003");
  ends.front().origin.entry = "0003";
  ends.front().state = JournalState::needs_operator;
  EXPECT_EQ(again.missing(ends).size(), 1U);
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

TEST(History, names_the_files_that_it_cannot_read) {
  const TemporaryFolder folder;
  const auto path = folder / "history";
  History whole(path);
  for (int i = 0; i < 3; ++i) add(whole, {});
  EXPECT_TRUE(History(path).unreadable().empty());
  std::ofstream(path / "0002.json") << R"({"id":"0002","time":1)";  // cut off
  History history(path);
  EXPECT_EQ(history.unreadable(), std::vector{path / "0002.json"});
  ASSERT_EQ(history.entries().size(), 2U);
  EXPECT_EQ(history.numbered({}).id, "0004");
  HistoryEntry of_the_journal;
  of_the_journal.id = "0002";
  history.keep(of_the_journal);
  EXPECT_TRUE(history.unreadable().empty()) << "it was made again";
}

// An empty history would give the next entry the number of one that is there.
TEST(History, that_cannot_be_listed_is_not_an_empty_one) {
  const TemporaryFolder folder;
  const auto path = folder / "history";
  EXPECT_FALSE(History(path).unlisted()) << "it is made on the first entry";
  std::filesystem::create_symlink(path, path);
  const History history(path);
  ASSERT_TRUE(history.unlisted());
  EXPECT_EQ(history.unlisted()->where, path.string());
  EXPECT_NE(history.unlisted()->what.find("cannot read the history: Too many levels"), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_FALSE(history.write(history.numbered({})).ok());
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(History, takes_over_what_a_later_look_finds_and_keeps_what_that_does_not_know) {
  const TemporaryFolder folder;
  const auto path = folder / "history";
  HistoryEntry first, second;
  first.id = "0001";
  second.id = "0002";
  first.outcome = "committed";
  second.outcome = "unknown";
  first.calibration = R"({"format":"x"})";
  ASSERT_TRUE(History(path).write(first).ok() && History(path).write(second).ok());
  std::filesystem::rename(path, folder / "aside");
  std::filesystem::create_symlink(path, path);
  History history(path);
  first.calibration.reset();  // as the journal has them
  second.outcome = "committed";
  for (const HistoryEntry& entry : {first, second}) history.keep(entry);
  history.take_over(History(path));
  EXPECT_TRUE(history.unlisted());
  std::filesystem::remove(path);
  std::filesystem::rename(folder / "aside", path);
  history.take_over(History(path));
  EXPECT_FALSE(history.unlisted());
  ASSERT_EQ(history.entries().size(), 2U);
  EXPECT_EQ(history.entries()[0].outcome, "committed");
  EXPECT_TRUE(history.entries()[1].calibration);
  EXPECT_EQ(history.numbered({}).id, "0003");
  EXPECT_TRUE(history.write(history.numbered(first)).ok());
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

// Entries that the fifty newest have pushed out do not come back with the next start.
TEST_F(FullHistory, misses_nothing_that_is_older_than_it_keeps) {
  JournalRecord end = record_of(JournalState::commit);
  end.origin = some_provenance();
  end.origin.entry = "0010";
  EXPECT_TRUE(history_.missing({end}).empty());
  end.origin.entry = "0011";
  EXPECT_EQ(history_.missing({end}).size(), 1U) << "kept, and told otherwise";
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
