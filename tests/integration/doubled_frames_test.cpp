// Write-backs over a line that doubles frames, lets them come late and out of order, and loses some: each
// ends wholly new or wholly old, and says which. The transaction and the driver as they are, on the simulated
// drive, in virtual time.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <ostream>

#include "daemon/writeback/transaction.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/drivers/base/cia402/drive_bench.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::doubled_frames_test {
namespace {

using drivers::drive_bench::Bench;
using Raw = std::array<std::uint32_t, 3>;

constexpr double kSdoTimeout_s = 0.5;  // of the driver

bool is_sdo(const sim::Frame& frame) { return frame.id == 0x581 || frame.id == 0x601; }
bool is_life_sign(const sim::Frame& frame) { return frame.id > 0x700; }
bool is_sdo_or_life_sign(const sim::Frame& frame) { return is_sdo(frame) || is_life_sign(frame); }

struct Line {
  const char* name;
  sim::LineFaults faults;
  friend std::ostream& operator<<(std::ostream& out, const Line& line) { return out << line.name; }
};

// Commands and process data are not late: counts that are older than 100 ms are none.
const Line kLines[] = {
    {"every_frame_twice", {.doubled = 1.0}},
    {"one_percent_lost", {.dropped = 0.01}},
    {"doubled_late_and_lost",
     {.doubled = 0.5,
      .dropped = 0.01,
      .late = 0.1,
      .latest = kSdoTimeout_s,
      .may_be_late = is_sdo_or_life_sign}},
};

class OverALine : public testing::TestWithParam<Line> {
 protected:
  struct Run : Bench {
    Run(const Line& line, std::uint64_t seed, const std::filesystem::path& folder)
        : journal(value_of(Journal::open(folder))), transaction(journal) {
      from_node = sim::FrameLine(line.faults, 2 * seed);
      to_node = sim::FrameLine(line.faults, 2 * seed + 1);
    }
    std::optional<WriteReport> end_of(double longest) {
      std::optional<WriteReport> report;
      const auto has_ended = [&] {
        if (!report) transaction.step(*controller, now, 0);
        if (!report) report = transaction.take_report();
        return report.has_value();
      };
      (void)run_until(has_ended, longest);
      return report;
    }
    Journal journal;
    Transaction transaction;
  };

  /// New values, and then the old ones again at once.
  void write_there_and_back(std::uint64_t seed) {
    const TemporaryFolder folder;
    Run run(GetParam(), seed, folder / "journal");
    ASSERT_TRUE(run.run_until(
        [&] {
          return run.controller->state() == drivers::ControllerState::disabled && run.controller->at_rest();
        },
        60.0));
    const std::array<Raw, 2> raw{{{150000, 150000, 400000}, {151000, 149000, 403000}}};
    Raw before = raw[0];
    for (const std::size_t to : {1U, 0U}) {
      const ParameterMap values{{"left_wheel_diameter", 1e-6 * raw[to][0]},
                                {"right_wheel_diameter", 1e-6 * raw[to][1]},
                                {"track_width", 1e-6 * raw[to][2]}};
      ASSERT_TRUE(run.transaction.write("apply", values).ok());
      const auto report = run.end_of(120.0);
      ASSERT_TRUE(report) << seed;
      run.run(kSdoTimeout_s);  // what is still on the line arrives
      ++ends_[static_cast<int>(report->outcome)];
      const bool committed = report->outcome == WriteOutcome::committed;
      const bool told = committed || report->outcome == WriteOutcome::rolled_back;
      EXPECT_TRUE(told) << "unknown, seed " << seed << ": " << report->error->text();
      const Raw& expected = committed ? raw[to] : before;
      const bool as_told = run.node.geometry_in_ram() == expected && run.node.geometry_stored() == expected;
      EXPECT_TRUE(as_told || !told) << "mixed or misreported, seed " << seed;
      before = run.node.geometry_in_ram();
    }
  }

  std::map<int, int> ends_;
};

/// Write-backs of each line. Chosen: a second and a half; ./test.sh --long has a thousand.
unsigned write_backs() { return std::getenv("ODOMCALIB_LONG") != nullptr ? 1000 : 100; }

TEST_P(OverALine, each_write_back_ends_wholly_new_or_wholly_old_and_says_which) {
  for (unsigned seed = 1; 2 * seed <= write_backs() && !HasFatalFailure(); ++seed) write_there_and_back(seed);
  const auto of = [&](WriteOutcome outcome) { return ends_[static_cast<int>(outcome)]; };
  std::printf("%d committed, %d rolled back, %d unknown\n", of(WriteOutcome::committed),
              of(WriteOutcome::rolled_back), of(WriteOutcome::unknown));
  EXPECT_GT(of(WriteOutcome::committed), 4 * of(WriteOutcome::rolled_back)) << "hardly any came to its end";
}

INSTANTIATE_TEST_SUITE_P(Line, OverALine, testing::ValuesIn(kLines),
                         [](const auto& line) { return line.param.name; });

}  // namespace
}  // namespace odomcalib::doubled_frames_test
