// Files that mean harm: much out of little, counts of everything, loops. An answer in bounded time and
// memory.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>

#include <chrono>
#include <functional>

#include "proto/recording/ros/unpack.hpp"
#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_hostile_test {
namespace {

using sim::RosPacking;
using sim::Wire;
using test::discarded_like;
using test::list_discarded;
using test::read_ros;
using test::small_log;

#if defined(ODOMCALIB_SANITIZED)
constexpr long kMoreMemory = 400;  // MiB; AddressSanitizer keeps 256 of what was freed
constexpr int kSlower = 10;        // as in tests/CMakeLists.txt
#else
constexpr long kMoreMemory = 0;
constexpr int kSlower = 1;
#endif

/// Largest memory of this process so far, in MiB.
long peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

std::string raw32(std::uint32_t value) {
  std::string out;
  for (unsigned i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i));
  return out;
}
std::string raw64(std::uint64_t value) {
  return raw32(static_cast<std::uint32_t>(value)) + raw32(static_cast<std::uint32_t>(value >> 32U));
}

std::string mcap_chunk(const std::string& name, const std::string& bytes, std::uint64_t stated) {
  const std::string content = raw64(0) + raw64(0) + raw64(stated) + raw32(0) +
                              raw32(static_cast<std::uint32_t>(name.size())) + name + raw64(bytes.size()) +
                              bytes;
  return std::string(1, '\x06') + raw64(content.size()) + content;
}

/// The drive of the other tests, with something in front of its first record.
std::string mcap_with(const std::string& records) {
  std::string file = write_mcap(small_log(Wire::cdr_little));
  return file.insert(8, records);
}

TEST(HostileRos, a_bomb_unpacks_to_no_more_than_it_states_or_the_limit) {
  constexpr std::size_t kBomb = 64 << 20;
  const std::string zeros(kBomb, '\0');
  for (const auto& [packing, as] : {std::pair(RosPacking::bz2, ros::Packing::bz2),
                                    {RosPacking::lz4, ros::Packing::lz4},
                                    {RosPacking::zstd, ros::Packing::zstd}}) {
    const std::string bomb = sim::packed(packing, zeros);
    constexpr std::size_t kLimit = 1000;
    const Unpacked cut = ros::unpack(as, bomb, kLimit);
    EXPECT_FALSE(cut.whole);
    EXPECT_LE(cut.bytes.size(), kLimit);
    const Unpacked whole = ros::unpack(as, bomb, kBomb);
    EXPECT_TRUE(whole.whole) << whole.problem;
    EXPECT_EQ(whole.bytes.size(), kBomb);
    ros::Unpacker unpacker(UnpackLimit::allowed(kBomb + kLimit));
    EXPECT_TRUE(unpacker(as, bomb, kBomb).whole);
    EXPECT_FALSE(unpacker.refusal("file"));
    EXPECT_FALSE(unpacker(as, bomb, kBomb).whole) << "all pieces together have one limit";
    EXPECT_TRUE(unpacker.refusal("file"));
    for (const std::uint64_t stated : {std::uint64_t{kBomb - 1}, std::uint64_t{kBomb + 1}, UINT64_MAX}) {
      ros::Unpacker other(UnpackLimit::allowed(4 * kBomb));
      EXPECT_FALSE(other(as, bomb, stated).whole) << "states " << stated;
      EXPECT_FALSE(other.refusal("file")) << "damage, not size";
    }
  }
}

TEST(HostileRos, bombs_in_chunks_cost_neither_memory_nor_the_rest_of_the_file) {
  const std::string mebibyte = sim::packed(RosPacking::zstd, std::string(1 << 20, '\0'));
  std::string bomb, chunks;
  for (int i = 0; i < 1024; ++i) bomb += mebibyte;
  const long before = peak_memory();
  for (int i = 0; i < 20; ++i) chunks += mcap_chunk("zstd", bomb, 1000);         // more than stated
  for (int i = 0; i < 20; ++i) chunks += mcap_chunk("zstd", bomb, 1ULL << 60U);  // states beyond all limits
  chunks += mcap_chunk("zstd", "no zstd at all", 100) + mcap_chunk("brotli", "x", 1) + mcap_chunk("", "x", 1);
  const auto result = value_of(read_ros(mcap_with(chunks)));
  EXPECT_EQ(result.ticks.size(), 200U) << list_discarded(result);
  EXPECT_EQ(discarded_like(result, "chunk", "unpacks to more than it states"), 20U);
  EXPECT_EQ(discarded_like(result, "chunk", "more than the limit of"), 20U);
  EXPECT_EQ(discarded_like(result, "chunk", "compressed data is damaged"), 1U) << list_discarded(result);
  EXPECT_LT(peak_memory() - before, 100 + kMoreMemory) << "MiB";
}

TEST(UnpackLimit, grows_with_the_file_up_to_256_MiB_or_what_was_allowed) {
  const UnpackLimit usual;
  EXPECT_EQ(usual.of(0), UnpackLimit::kLeast);
  EXPECT_EQ(usual.of(200'000), 40'000'000U);
  EXPECT_EQ(usual.of(std::size_t{1} << 40U), UnpackLimit::kMost);
  EXPECT_EQ(UnpackLimit::allowed(1000).of(1), 1000U);
  EXPECT_NE(usual.refusal(200'000, "file").text().find("38 MiB, 200 times its size"), std::string::npos);
  EXPECT_NE(usual.refusal(1, "file").text().find("16 MiB; where"), std::string::npos);
  EXPECT_EQ(usual.refusal(std::size_t{1} << 40U, "file").remedy,
            "where it can be trusted: --unpack-limit 512");
}

/// A recording that is followed by nothing, much of it, packed in each way.
std::vector<std::pair<const char*, std::string>> swollen_files() {
  const std::string nothing(std::size_t{40} << 20, '\n');
  const std::string robot =
      R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})";
  return {{"gzip", value_of(gzip(robot + nothing))},
          {"zstd", sim::packed(RosPacking::zstd, write_mcap(small_log(Wire::cdr_little)) + nothing)},
          {"chunk", mcap_with(mcap_chunk("zstd", sim::packed(RosPacking::zstd, nothing), nothing.size()) +
                              mcap_chunk("zstd", sim::packed(RosPacking::zstd, nothing), nothing.size()))}};
}

TEST(HostileRos, much_out_of_little_is_refused_and_the_switch_is_named) {
  for (const auto& [name, file] : swollen_files()) {
    ASSERT_LT(file.size(), 500'000U) << name;
    const long before = peak_memory();
    const auto begin = std::chrono::steady_clock::now();
    const auto refused = read_recording_bytes(file, "swollen");
    ASSERT_FALSE(refused.ok()) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::format);
    const bool is_of_lines = is_gzip(file);
    const char* const advice = is_of_lines ? "--unpack-limit 2048" : "--unpack-limit 512";
    EXPECT_NE(refused.error().remedy.find(advice), std::string::npos) << refused.error().text();
    EXPECT_LT(peak_memory() - before, 60 + kMoreMemory) << name;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(kSlower)) << name;
    const auto allowed =
        read_recording_bytes(file, "swollen", nullptr, {}, UnpackLimit::allowed(std::size_t{1} << 30));
    const std::string said = allowed.ok() ? "" : allowed.error().text();
    EXPECT_EQ(said.find("unpacks to more"), std::string::npos) << said;
  }
}

TEST(HostileRos, a_packed_recording_is_bounded_too) {
  const auto result = read_ros(sim::packed(RosPacking::zstd, std::string(1 << 20, '\0')));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::format);
}

/// Every 32-bit number of a message set to the largest there is: counts, lengths, alignments.
TEST(HostileRos, counts_beyond_the_message_are_damage_and_reserve_nothing) {
  const long before = peak_memory();
  for (const Wire wire : {Wire::ros1, Wire::cdr_little, Wire::cdr_big}) {
    const sim::RosLog good = small_log(wire);
    for (std::size_t at = 0; at + 4 <= 200; at += 4) {
      sim::RosLog log = good;
      for (auto& message : log.messages)
        if (at + 4 <= message.bytes.size()) message.bytes.replace(at, 4, 4, '\xFF');
      const auto result = read_ros(write_mcap(log));
      if (result.ok()) {
        EXPECT_LE(result.value().ticks.size(), 200U);
      }
    }
  }
  EXPECT_LT(peak_memory() - before, 100 + kMoreMemory) << "MiB";
}

/// Every 32-bit number of a container set to the largest there is.
TEST(HostileRos, lengths_beyond_the_file_are_damage) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string bag = write_bag(small_log(Wire::ros1), {.chunk_bytes = 3000});
  const std::string mcap = write_mcap(small_log(Wire::cdr_little), {.chunk_bytes = 3000});
  for (const std::string* file : {&bag, &mcap})
    for (std::size_t at = 13; at + 4 < 6000; ++at) {
      std::string changed = *file;
      changed.replace(at, 4, 4, '\xFF');
      (void)read_ros(changed);
    }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kSlower * std::chrono::seconds(60));
}

TEST(HostileRos, topics_without_end_are_bounded) {
  sim::RosLog log = small_log(Wire::ros1);
  for (int i = 0; i < 70'000; ++i) log.add("/t" + std::to_string(i), "std_msgs/String", 1, "");
  (void)read_ros(sim::write_bag({log.wire, log.topics, {}}));  // without messages nothing is described
  const auto result = value_of(read_ros(write_bag(log, {.chunk_bytes = 1 << 20})));
  EXPECT_GE(discarded_like(result, "connection", "too many topics"), 1U);
}

TEST(HostileRos, names_of_joints_that_always_differ_are_bounded) {
  sim::RosLog log = small_log(Wire::cdr_little);
  for (int i = 0; i < 5000; ++i)
    log.add("/joint_states", "sensor_msgs/JointState", 1'700'000'000'000'000'000 + i,
            encode_joints(log.wire, {1'700'000'000'000'000'000 + i, ""}, {"joint" + std::to_string(i)}, {0.0},
                          {}));
  const auto result = value_of(read_ros(write_mcap(log)));
  EXPECT_GE(discarded_like(result, "message", "/joint_states: does not hold"), 4000U);
  EXPECT_EQ(result.ticks.size(), 200U);
}

TEST(HostileRos, names_reach_no_terminal_unchanged) {
  sim::RosLog log = small_log(Wire::cdr_little);
  log.add("/evil\x1b[2J\n", "sensor_msgs/LaserScan", 1,
          encode_scan(log.wire, {1, "x"}, test::small_drive().scans.front()));
  const auto result = read_ros(write_mcap(log));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().text().find('\x1b'), std::string::npos);
  EXPECT_NE(result.error().text().find("/evil?[2J?"), std::string::npos) << result.error().text();
}

// ---- SQLite

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;

std::string database_of(const std::string& sql) {
  const auto path = test::write_file("hostile.db3", "");
  sqlite3* opened = nullptr;
  EXPECT_EQ(sqlite3_open(path.c_str(), &opened), SQLITE_OK);
  const Database database(opened, sqlite3_close);
  EXPECT_EQ(sqlite3_exec(opened, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(opened);
  std::string bytes = test::bytes_of(path);
  std::filesystem::remove(path);
  return bytes;
}

constexpr const char* kTopics =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
    "INSERT INTO topics VALUES(1, '/odom', 'nav_msgs/msg/Odometry', 'cdr');";

void expect_answer(const std::string& bytes) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = read_ros(bytes);
  EXPECT_FALSE(result.ok());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kSlower * std::chrono::seconds(20));
}

TEST(HostileRos, views_that_never_end_are_no_tables) {
  expect_answer(
      database_of(std::string(kTopics) +
                  "CREATE VIEW messages AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
                  " SELECT i AS id, 1 AS topic_id, i AS timestamp, zeroblob(1000000) AS data FROM n;"));
}

TEST(HostileRos, computed_columns_make_no_large_rows) {
  expect_answer(
      database_of(std::string(kTopics) +
                  "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
                  " data BLOB AS (zeroblob(900000000)));"
                  "INSERT INTO messages(topic_id, timestamp) VALUES(1, 1), (1, 2), (1, 3);"));
}

/// Pages of the tree of messages that name each other as children.
TEST(HostileRos, trees_that_bite_their_tail_end) {
  const auto path = test::write_file("cycle.db3", "");
  write_rosbag2(small_log(Wire::cdr_little), path);
  const std::string good = test::bytes_of(path);
  std::filesystem::remove(path);
  constexpr std::size_t kPage = 4096;
  constexpr char kInteriorTable = 5;
  std::size_t changed = 0;
  for (std::size_t page = 1; (page + 1) * kPage <= good.size(); ++page) {
    if (good[page * kPage] != kInteriorTable) continue;
    std::string cyclic = good;
    const std::size_t cells = static_cast<unsigned char>(good[page * kPage + 3]) * 256U +
                              static_cast<unsigned char>(good[page * kPage + 4]);
    const std::string itself{'\0', '\0', static_cast<char>((page + 1) >> 8U), static_cast<char>(page + 1)};
    for (std::size_t k = 0; k < cells; ++k) {
      const std::size_t pointer = page * kPage + 12 + 2 * k;
      const std::size_t cell = page * kPage + static_cast<unsigned char>(good[pointer]) * 256UL +
                               static_cast<unsigned char>(good[pointer + 1]);
      cyclic.replace(cell, 4, itself);
    }
    ++changed;
    const auto begin = std::chrono::steady_clock::now();
    const auto result = read_ros(cyclic);
    if (result.ok()) {
      EXPECT_GE(discarded_like(result.value(), "file", ""), 1U);
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, kSlower * std::chrono::seconds(20));
  }
  EXPECT_GT(changed, 0U) << "the drive is too small for an inner page";
}

TEST(HostileRos, headers_of_sqlite_that_lie_are_answered) {
  const auto path = test::write_file("header.db3", "");
  write_rosbag2(small_log(Wire::cdr_little), path);
  const std::string good = test::bytes_of(path);
  std::filesystem::remove(path);
  for (std::size_t at = 16; at < 100; ++at)
    for (const char value : {'\0', '\x01', '\x7F', '\xFF'}) {
      std::string changed = good;
      changed[at] = value;
      const auto result = read_ros(changed);
      if (result.ok()) {
        EXPECT_LE(result.value().ticks.size(), 200U);
      }
    }
}

}  // namespace
}  // namespace odomcalib::ros_hostile_test
