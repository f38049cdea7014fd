#include "tests/bench/bare_relay.hpp"

#include <fcntl.h>
#include <lcm/lcm.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <thread>

#include "tests/sim/wires/pty.hpp"

namespace odomcalib::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kTicksBytes = 52, kOdometryBytes = 160;  // about those of the daemon's messages
const std::string kFrame = "t18180102030405060708\r";          // slcan, eight bytes of data

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Relay {
 public:
  Relay(const std::string& url, const sim::Pty& pty, std::size_t frames)
      : sent_(frames), lcm_(lcm_create(url.c_str())), port_(open(pty.path().c_str(), O_RDONLY | O_NOCTTY)) {
    if (!lcm_ || port_ < 0) throw std::runtime_error("bare relay: no LCM or no pseudo-terminal");
  }
  ~Relay() {
    lcm_destroy(lcm_);
    close(port_);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  void note_sending(std::size_t frame) { sent_[frame] = Clock::now(); }

  /// Until every frame came, or none for a second.
  RelayRun run() {
    RelayRun result;
    const double begin = thread_seconds();
    const auto start = Clock::now();
    pollfd port{port_, POLLIN, 0};
    while (result.latencies_ms.size() < sent_.size() && poll(&port, 1, 1000) > 0) {
      std::array<char, 4096> bytes;
      const ssize_t count = read(port_, bytes.data(), bytes.size());
      if (count <= 0) break;
      for (auto ends = std::count(bytes.begin(), bytes.begin() + count, '\r'); ends > 0; --ends)
        pass_on(result);
    }
    const std::chrono::duration<double> took = Clock::now() - start;
    result.cpu_share = (thread_seconds() - begin) / took.count();
    return result;
  }

 private:
  void pass_on(RelayRun& result) {
    if (result.latencies_ms.size() >= sent_.size()) return;
    lcm_publish(lcm_, "BARE_TICKS", message_.data(), kTicksBytes);
    const std::chrono::duration<double, std::milli> late =
        Clock::now() - sent_[result.latencies_ms.size()].load();
    lcm_publish(lcm_, "BARE_ODOM", message_.data(), kOdometryBytes);
    result.latencies_ms.push_back(late.count());
  }

  std::vector<std::atomic<Clock::time_point>> sent_;
  lcm_t* lcm_;
  int port_;
  std::array<char, kOdometryBytes> message_{};
};

}  // namespace

RelayRun run_bare_relay(const std::string& lcm_url, double seconds) {
  const auto pty = std::move(sim::Pty::open()).value();
  const auto frames = static_cast<std::size_t>(1000.0 * seconds);
  Relay relay(lcm_url, *pty, frames);
  std::thread device([&] {
    auto due = Clock::now();
    for (std::size_t k = 0; k < frames; ++k) {
      std::this_thread::sleep_until(due += std::chrono::milliseconds(1));
      relay.note_sending(k);
      pty->write(kFrame);
    }
  });
  RelayRun result = relay.run();
  device.join();
  return result;
}

}  // namespace odomcalib::bench
