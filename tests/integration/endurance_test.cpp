// The service over many starts and stops, and over hours of motion, in virtual time: what it holds of the
// machine afterwards is what it held before. The long runs are in docs/evidence/faults.md.
#include <malloc.h>

#include <cstdlib>
#include <random>

#include "tests/integration/service_loop.hpp"

namespace odomcalib::endurance_test {
namespace {

/// Resources that a process may leak.
struct Held {
  std::size_t heap = 0;  // bytes in use
  std::ptrdiff_t descriptors = 0, threads = 0, files = 0;
};

std::ptrdiff_t entries(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::recursive_directory_iterator all(folder, error);
  return error ? 0 : std::distance(begin(all), end(all));
}

std::ptrdiff_t members(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

unsigned from_environment(const char* name, unsigned usual) {
  const char* const given = std::getenv(name);
  return given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : usual;
}

class Endurance : public ServiceLoop {
 protected:
  using ServiceLoop::adjust;
  void adjust(Config& config) override { config.keep_recordings = 3'000'000; }

  Held held() const {
    return {mallinfo2().uordblks, members("/proc/self/fd"), members("/proc/self/task"),
            entries(folder_ / "state")};
  }
  /// Half of the run has filled what is bounded; the other half must add nothing.
  void expect_no_growth(const Held& half, const Held& whole) const {
    constexpr std::size_t kNoise = 256 << 10;  // bytes: buffers of the C library, of one recording
    std::printf("heap %zu -> %zu bytes, descriptors %td -> %td, threads %td -> %td, files %td -> %td\n",
                half.heap, whole.heap, half.descriptors, whole.descriptors, half.threads, whole.threads,
                half.files, whole.files);
    EXPECT_LE(whole.heap, half.heap + kNoise);
    EXPECT_EQ(whole.descriptors, half.descriptors);
    EXPECT_LE(whole.threads, half.threads + 1) << "one may still be ending";
    EXPECT_LE(whole.files, half.files + 4) << "beyond what is kept";
  }
  void move(bool straight) {
    TestClient mover(folder_ / "control");
    if (straight)
      mover.call("Straight", {{"lease", lease_}, {"distance", 0.6}}, true);
    else
      mover.call("Spin", {{"lease", lease_}, {"turns", 0.25}, {"direction", "both"}}, true);
    const auto reply = wait_reply(mover, 60.0);
    EXPECT_EQ(reply.error, "") << reply.parameters;
  }
  void settle() {
    client_.reset();
    lease_.clear();
    renewing_ = false;
    run(1.0);
  }
};

class Cycles : public Endurance {
 protected:
  /// @return it moved
  bool start_and_stop(std::mt19937_64& random) {
    acquire();
    const bool spin = random() % 4 != 0;
    const bool left = random() % 2 == 0;
    const double moving = std::uniform_real_distribution(0.02, 0.4)(random);
    TestClient mover(folder_ / "control");
    if (spin)
      mover.call("Spin", {{"lease", lease_}, {"turns", 1.0}, {"direction", left ? "ccw" : "cw"}}, true);
    else
      mover.call("Straight", {{"lease", lease_}, {"distance", left ? 0.5 : -0.5}}, true);
    std::optional<control::Reply> ended;
    const bool moved =
        run_until([&] { return robot_->fastest_rim() > 0.02 || (ended = mover.reply()).has_value(); }, 8.0) &&
        !ended;
    if (moved) run(moving);
    mover.call("Stop", json::object());
    EXPECT_TRUE(run_until([this] { return robot_->fastest_rim() < 1e-3; }, 2.0)) << "it still turns";
    EXPECT_TRUE(run_until([this] { return ready(); }, 5.0)) << service_->status_json();
    lease_.clear();
    client_.reset();
    run(0.1);
    return moved;
  }
  void restart_service() {
    service_.reset();
    renewing_ = false;
    start_service();
    ASSERT_TRUE(run_until([this] { return ready(); }, 10.0)) << service_->status_json();
  }
};

TEST_F(Cycles, of_start_and_stop_leave_nothing_behind) {
  const unsigned cycles = from_environment("ODOMCALIB_CYCLES", 120);
  std::mt19937_64 random(20261127);
  unsigned moved = 0;
  Held half;
  for (unsigned i = 0; i < cycles && !HasFailure(); ++i) {
    moved += start_and_stop(random) ? 1U : 0U;
    if (i % 10 == 9) restart_service();
    if (i + 1 != cycles / 2) continue;
    settle();
    half = held();
  }
  settle();
  std::printf("%u cycles, %u of them with motion, %u restarts of the service\n", cycles, moved, cycles / 10);
  EXPECT_GE(moved, cycles * 9 / 10);
  expect_no_growth(half, held());
}

TEST_F(Endurance, of_motion_after_motion_adds_nothing) {
  const double seconds = from_environment("ODOMCALIB_SOAK", 240);
  Held half;
  const double begin = clock_.time;
  unsigned motions = 0;
  while (clock_.time - begin < seconds && !HasFailure()) {
    acquire();
    move(motions++ % 2 == 0);
    settle();
    if (half.heap == 0 && clock_.time - begin > seconds / 2) half = held();
  }
  std::printf("%u motions in %.0f s\n", motions, clock_.time - begin);
  settle();
  expect_no_growth(half, held());
}

}  // namespace
}  // namespace odomcalib::endurance_test
