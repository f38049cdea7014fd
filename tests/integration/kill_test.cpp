// The daemon is killed after each record of its journal, as a whole program on the real CANopen driver, and
// so is the daemon that recovers: what the simulated drive holds in the end is wholly old or wholly new, in
// its RAM and in its permanent memory.
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/writeback/journal.hpp"
#include "proto/file_bytes.hpp"
#include "tests/integration/processes.hpp"

namespace odomcalib::test_support::kill_test {
namespace {

using nlohmann::json;
using Lengths = std::array<double, 3>;

constexpr Lengths kOld{0.150, 0.150, 0.400}, kNew{0.1512, 0.1498, 0.4033};
constexpr int kKilled = 128 + SIGKILL;

bool same(const Lengths& a, const Lengths& b) {
  return std::abs(a[0] - b[0]) < 1e-7 && std::abs(a[1] - b[1]) < 1e-7 && std::abs(a[2] - b[2]) < 1e-7;
}

/// When a daemon is killed: after so many records of its journal, and so many more SDO requests.
struct Death {
  int records = 0;  ///< 0: it lives
  int requests = 0;
};

/// While it lives, daemons that are started die like this.
class Killed {
 public:
  explicit Killed(const Death& death) {
    if (death.records == 0) return;
    setenv("LD_PRELOAD", ODOMCALIB_KILL_LIBRARY, 1);
    setenv("ODOMCALIB_KILL_AFTER_SYNC", std::to_string(death.records).c_str(), 1);
    setenv("ODOMCALIB_KILL_AFTER_REQUEST", std::to_string(death.requests).c_str(), 1);
    setenv("ASAN_OPTIONS", "verify_asan_link_order=0", 1);
  }
  ~Killed() {
    for (const char* name :
         {"LD_PRELOAD", "ODOMCALIB_KILL_AFTER_SYNC", "ODOMCALIB_KILL_AFTER_REQUEST", "ASAN_OPTIONS"})
      unsetenv(name);
  }
  Killed(const Killed&) = delete;
  Killed& operator=(const Killed&) = delete;
};

enum class Values { old, fresh };

struct Deaths {
  Death of_writer, of_recovery;
  Values in_the_end;
  bool power_cycled = false;  ///< the drive loses its RAM after the first death
};

std::ostream& operator<<(std::ostream& out, const Deaths& deaths) {
  out << deaths.of_writer.records << "+" << deaths.of_writer.requests << " then "
      << deaths.of_recovery.records;
  return out << (deaths.power_cycled ? ", power cycle" : "");
}

class KillAfterRecord : public ::testing::TestWithParam<Deaths> {
 protected:
  void restart(const Death& death = {}) {
    both_.daemon.reset();
    const Killed killed(death);
    both_.start_daemon();
  }
  Lengths values() {
    const json robot = json::parse(both_.status(), nullptr, false)["robot"];
    return {robot["left_wheel_diameter"], robot["right_wheel_diameter"], robot["track_width"]};
  }
  /// Outcome of the newest entry of the history; the journal alone knew it when the daemon died.
  std::string newest_outcome() {
    auto asked = both_.run({"history", "--json"});
    EXPECT_EQ(asked->wait(10.0), 0) << both_.output();
    const json entries = json::parse(both_.output(), nullptr, false).value("entries", json::array());
    return entries.empty() ? "" : entries[0].value("outcome", "");
  }
  bool recovered() {
    const json now = json::parse(both_.status(), nullptr, false);
    return both_.ready() && now["operator_needed"] == false;
  }
  RobotAndDaemon both_{3};
};

TEST_P(KillAfterRecord, ends_with_wholly_old_or_wholly_new_values) {
  ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  restart(GetParam().of_writer);
  ASSERT_TRUE(wait_until([this] { return both_.ready(); }, 20.0)) << both_.status();
  auto client = both_.run({"params", "set", "--yes", "left_wheel_diameter=0.1512",
                           "right_wheel_diameter=0.1498", "track_width=0.4033"});
  ASSERT_EQ(both_.daemon->wait(10.0), kKilled) << both_.output();
  if (GetParam().power_cycled) both_.robot->tell("reset drive");
  if (GetParam().of_recovery.records > 0) {
    restart(GetParam().of_recovery);
    ASSERT_EQ(both_.daemon->wait(10.0), kKilled) << both_.status();
  }
  restart();
  ASSERT_TRUE(wait_until([this] { return recovered(); }, 10.0)) << both_.status();
  const std::string journal = read_file_bytes(both_.folder() / "state" / "journal").value();
  EXPECT_FALSE(Journal::open(both_.folder() / "state" / "journal").value().unfinished()) << journal;
  // Between two writes the drive holds a mixture: it must have been seen and undone.
  if (GetParam().of_writer.requests > 0) {
    EXPECT_NE(journal.find("\"rollback\""), std::string::npos) << journal;
  }
  const Lengths& expected = GetParam().in_the_end == Values::fresh ? kNew : kOld;
  EXPECT_TRUE(same(values(), expected)) << both_.status();
  EXPECT_EQ(newest_outcome(), GetParam().in_the_end == Values::fresh ? "committed" : "rolled_back");
  // The drive wakes up with the same values.
  both_.daemon.reset();
  both_.robot->tell("reset drive");
  restart();
  ASSERT_TRUE(wait_until([this] { return recovered(); }, 10.0)) << both_.status();
  EXPECT_TRUE(same(values(), expected)) << both_.status();
}

// Records: begin, write, readback_ok, store_begin, store_ok, commit. Between write and readback_ok three
// values are read (3 requests), then each is written and read again (2 requests each).
const Deaths kDeaths[] = {
    {{1}, {}, Values::old},       {{2}, {}, Values::old},         {{2, 5}, {}, Values::old},
    {{2, 6}, {}, Values::old},    {{2, 7}, {}, Values::old},      {{2, 6}, {1}, Values::old},
    {{2, 6}, {2}, Values::old},   {{3}, {}, Values::fresh},       {{4}, {}, Values::fresh},
    {{5}, {}, Values::fresh},     {{6}, {}, Values::fresh},       {{3}, {}, Values::old, true},
    {{4}, {}, Values::old, true}, {{5}, {}, Values::fresh, true}, {{4}, {1}, Values::fresh},
    {{4}, {2}, Values::fresh},    {{4}, {3}, Values::fresh},      {{4}, {1}, Values::old, true},
    {{4}, {2}, Values::old, true}};

INSTANTIATE_TEST_SUITE_P(Processes, KillAfterRecord, ::testing::ValuesIn(kDeaths));

}  // namespace
}  // namespace odomcalib::test_support::kill_test
