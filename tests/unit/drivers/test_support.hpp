// Common parts of the driver tests: seeds, byte strings, the accounting law.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/can/transport.hpp"
#include "drivers/lidar/lidar.hpp"
#include "tests/shared_folder.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::drivers::test {

using ByteString = std::vector<std::uint8_t>;

/// Random 32-bit numbers, the same on every machine.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  unsigned operator()() { return static_cast<unsigned>(engine_()); }

 private:
  std::mt19937 engine_;
};

/// Every random test prints its seed, so that a failure can be run again: ODOMCALIB_TEST_SEED=n.
inline Random seeded(unsigned usual) {
  const char* given = std::getenv("ODOMCALIB_TEST_SEED");
  const unsigned seed = given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : usual;
  std::printf("seed %u\n", seed);
  return Random(seed);
}

inline std::uint8_t random_byte(Random& random) { return static_cast<std::uint8_t>(random() & 0xFF); }

inline ByteString bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

/// bytes_in = good + skipped + buffered, at any moment.
inline void expect_accounted(const Counters& counters) {
  EXPECT_EQ(counters.at("bytes_in"), counters.at("good") + counters.at("skipped") + counters.at("buffered"));
}

/// All of a frame but its time.
inline void expect_same(const CanFrame& a, const CanFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.extended, b.extended);
  EXPECT_EQ(a.remote, b.remote);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.data, b.data);
}

/// Scans of whole turns since the last call.
inline std::vector<Scan> whole_scans(Lidar& lidar) {
  std::vector<Scan> out;
  for (LidarScan& given : lidar.take_scans())
    if (!given.partial) out.push_back(std::move(given.scan));
  return out;
}

/// A folder of recordings that are not part of the repository; empty when it is absent.
inline std::filesystem::path present_folder(const char* name) {
  const std::filesystem::path folder = shared_folder(name);
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

/// Real captures.
inline std::filesystem::path captures() { return present_folder("captures"); }
/// Situations that users of other tools reported, made small.
inline std::filesystem::path cases() { return present_folder("cases"); }

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream out;
  out << file.rdbuf();
  return out.str();
}

}  // namespace odomcalib::drivers::test

/// For tests on what is not part of the repository: defines `folder`, or skips loudly.
// NOLINTBEGIN(bugprone-macro-parentheses): a declaration takes none
#define ODOMCALIB_CAPTURES(folder)                          \
  const auto folder = odomcalib::drivers::test::captures(); \
  if (folder.empty()) GTEST_SKIP() << "no captures: set ODOMCALIB_SHARED to the folder that holds captures/"
// NOLINTEND(bugprone-macro-parentheses)
