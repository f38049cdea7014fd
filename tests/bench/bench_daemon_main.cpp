// bench_daemon: the unmodified odomcalibd under the largest load it is built for, in real time: counts of
// both wheels every millisecond over CAN (an slcan adapter), 40 scans a second of 1081 beams over TCP. Prints
// what was lost, the time from a frame to its LCM message, and the processor and memory the daemon took.
//
// LCM needs multicast, which tests/bench/daemon_load sets up in a network namespace of its own.
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/bare_relay.hpp"
#include "tests/bench/lcm_listener.hpp"
#include "tests/bench/wire_player.hpp"

namespace {

using namespace odomcalib::bench;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
constexpr double kStartUp = 30.0;  // s until reports must have come
constexpr double kSettle = 3.0;    // s
constexpr double kBound = 30.0;    // s, at most, for the bound before and after the measurement

struct Bars {
  double latency_ms = 1.0, cpu_percent = 5.0, memory_mb = 40.0;
};

struct Arguments {
  double seconds = 600.0;
  bool priority = false;
  Bars bars;
};

/// A folder with the daemon's configuration, gone with this object.
class Workplace {
 public:
  explicit Workplace(const WirePlayer& player) {
    std::string name = "/tmp/odomcalib-bench-XXXXXX";
    folder_ = mkdtemp(name.data());
    write_profile();
    std::ofstream(folder_ / "odomcalib.toml")
        << "[controller]\ndevice = \"" << player.can_device() << "\"\nprofile = \""
        << (folder_ / "profile.toml").string() << "\"\n[lidar]\ndevice = \"" << player.lidar_device()
        << "\"\ntype = \"hokuyo\"\npose = [0.1, 0.0, 0.0]\n[robot]\nwheel_diameter = 0.150\ntrack_width = "
        << "0.400\n[lcm]\nurl = \"" << kUrl << "\"\n[daemon]\nstate_dir = \"" << (folder_ / "state").string()
        << "\"\nsocket = \"" << (folder_ / "control").string() << "\"\n";
  }
  ~Workplace() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  /// The profile of the simulated drive, with its counts every millisecond.
  void write_profile() const {
    std::ifstream file(ODOMCALIB_PROFILE);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string usual = "event_timer = 20";
    if (const auto at = text.find(usual); at != std::string::npos)
      text.replace(at, usual.size(), "event_timer = 1");
    std::ofstream(folder_ / "profile.toml") << text;
  }

  std::filesystem::path folder_;
};

class Daemon {
 public:
  explicit Daemon(const std::filesystem::path& folder) {
    const std::string config = folder / "odomcalib.toml";
    std::vector<std::string> words{ODOMCALIB_DAEMON, "--config", config};
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (auto& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    if (posix_spawn(&pid_, ODOMCALIB_DAEMON, nullptr, nullptr, pointers.data(), environ) != 0) pid_ = -1;
  }
  ~Daemon() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Processor time of all its threads so far, s: fields 14 and 15 of proc(5) stat.
  [[nodiscard]] double cpu() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::vector<std::string> all{std::istream_iterator<std::string>(fields), {}};
    if (all.size() < 13) return 0.0;
    return (std::stod(all[11]) + std::stod(all[12])) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
  /// Largest resident memory so far, MB: VmHWM of proc(5) status.
  [[nodiscard]] double memory() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(file, line);)
      if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) * 1024.0 / 1e6;
    return 0.0;
  }

 private:
  pid_t pid_ = -1;
};

void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

bool reports_come(const LcmListener& listener) {
  for (double waited = 0.0; waited < kStartUp; waited += 0.05) {
    if (listener.ticks_seen() > 100) return true;
    pause(0.05);
  }
  return false;
}

/// Datagrams that the kernel dropped because this program did not read them in time: column "drops" of
/// proc(5) net/udp, for the port of kUrl.
std::size_t dropped_here() {
  std::ifstream file("/proc/net/udp");
  std::size_t dropped = 0;
  for (std::string line; std::getline(file, line);)
    if (line.find(":1DF3 ") != std::string::npos)
      dropped += std::stoul(line.substr(line.find_last_of(' ', line.find_last_not_of(' ')) + 1));
  return dropped;
}

struct Latency {
  double p50 = 0.0, p90 = 0.0, p99 = 0.0, p999 = 0.0, worst = 0.0;  ///< ms
};

Latency latency_of(std::vector<double> times_ms) {
  if (times_ms.empty()) return {};
  std::sort(times_ms.begin(), times_ms.end());
  const auto at = [&](double share) {
    return times_ms[static_cast<std::size_t>(share * static_cast<double>(times_ms.size() - 1))];
  };
  return {at(0.5), at(0.9), at(0.99), at(0.999), times_ms.back()};
}

void show(const char* what, const Latency& latency) {
  std::printf("%-34s p50 %.3f  p90 %.3f  p99 %.3f  p99.9 %.3f  worst %.3f ms\n", what, latency.p50,
              latency.p90, latency.p99, latency.p999, latency.worst);
}

/// The measured interval: reports with these left counts, scans with these numbers.
struct Interval {
  std::int64_t first = 0, last = 0;
  std::int64_t begin = 0, end = 0;  ///< ns of CLOCK_REALTIME
  [[nodiscard]] std::int64_t reports() const { return last - first + 1; }
};

struct Ticks {
  std::size_t lost = 0, twice = 0;
  Latency published, handled;
};

Ticks ticks_of(const WirePlayer& player, const LcmListener& listener, const Interval& interval) {
  std::vector<int> times(static_cast<std::size_t>(interval.reports()));
  std::vector<double> published, handled;
  for (const Seen& seen : listener.ticks()) {
    if (seen.count < interval.first || seen.count > interval.last) continue;
    ++times[static_cast<std::size_t>(seen.count - interval.first)];
    published.push_back(1e-6 * static_cast<double>(seen.published - player.sent_at(seen.count)));
    handled.push_back(1e-6 * static_cast<double>(seen.handled - player.sent_at(seen.count)));
  }
  Ticks out;
  out.lost = static_cast<std::size_t>(std::count(times.begin(), times.end(), 0));
  out.twice =
      static_cast<std::size_t>(std::count_if(times.begin(), times.end(), [](int n) { return n > 1; }));
  out.published = latency_of(std::move(published));
  out.handled = latency_of(std::move(handled));
  return out;
}

struct Scans {
  std::size_t sent = 0, seen = 0;
  Latency published;
};

/// A scan's message belongs to the newest scan that was sent before it.
Scans scans_of(const WirePlayer& player, const LcmListener& listener, const Interval& interval) {
  Scans out;
  const auto within = [&](std::int64_t t) { return t >= interval.begin && t < interval.end; };
  std::size_t i = 0;
  std::vector<double> published;
  std::vector<std::int64_t> starts;
  for (; i < player.scans_sent(); ++i) starts.push_back(player.scan_sent_at(i));
  out.sent = static_cast<std::size_t>(std::count_if(starts.begin(), starts.end(), within));
  for (const Seen& seen : listener.scans()) {
    const auto after = std::upper_bound(starts.begin(), starts.end(), seen.published);
    if (after == starts.begin() || !within(*(after - 1))) continue;
    ++out.seen;
    published.push_back(1e-6 * static_cast<double>(seen.published - *(after - 1)));
  }
  out.published = latency_of(std::move(published));
  return out;
}

/// @return true when the bar holds
bool judge(const char* what, double value, double bar) {
  const bool holds = value <= bar;
  std::printf("%-34s %.3f (bar %.1f) %s\n", what, value, bar, holds ? "holds" : "MISSED");
  return holds;
}

struct Usage {
  double cpu_s = 0.0, memory_mb = 0.0;
  std::size_t dropped = 0;  ///< by the listening side, not by the daemon
};

int report(const Arguments& arguments, const WirePlayer& player, const LcmListener& listener,
           const Interval& interval, const Usage& usage) {
  const Ticks ticks = ticks_of(player, listener, interval);
  const Scans scans = scans_of(player, listener, interval);
  const double seconds = 1e-9 * static_cast<double>(interval.end - interval.begin);
  std::printf("measured %.1f s; %lld reports, lost %zu, twice %zu; %zu scans, %zu published; wrong %zu\n",
              seconds, static_cast<long long>(interval.reports()), ticks.lost, ticks.twice, scans.sent,
              scans.seen, listener.wrong());
  std::printf("the player was late %llu times by more than 0.5 ms; bytes not taken by the port: %llu\n",
              static_cast<unsigned long long>(player.late()),
              static_cast<unsigned long long>(player.overrun()));
  std::printf("datagrams dropped at the listening socket: %zu\n", usage.dropped);
  show("frame to LCM publication", ticks.published);
  show("frame to a subscriber's handler", ticks.handled);
  show("scan to LCM publication", scans.published);
  bool good =
      judge("lost", static_cast<double>(ticks.lost + (scans.sent - std::min(scans.sent, scans.seen))), 0.0);
  good &= judge("frame to publication p99, ms", ticks.published.p99, arguments.bars.latency_ms);
  good &= judge("processor, % of one core", 100.0 * usage.cpu_s / seconds, arguments.bars.cpu_percent);
  good &= judge("memory, MB", usage.memory_mb, arguments.bars.memory_mb);
  return good ? 0 : 1;
}

void show_bound(const Arguments& arguments, const char* when) {
  RelayRun run = run_bare_relay(kUrl, std::min(kBound, arguments.seconds / 2.0));
  std::printf("bound %s: no more than reading and sending takes %.3f %% of one core\n", when,
              100.0 * run.cpu_share);
  show("frame to LCM, bound", latency_of(std::move(run.latencies_ms)));
}

/// Inherited by every thread and by the daemon: on a busy machine the figures are those of an idle one.
void take_priority() {
  const sched_param first{.sched_priority = 10};
  if (sched_setscheduler(0, SCHED_RR, &first) != 0)
    std::fprintf(stderr, "bench_daemon: no right to a real-time priority\n");
}

int measure(const Arguments& arguments) {
  if (arguments.priority) take_priority();
  LcmListener listener(kUrl);
  if (!listener.usable()) return std::fprintf(stderr, "bench_daemon: LCM has no multicast here\n"), 2;
  show_bound(arguments, "before");
  WirePlayer player(arguments.seconds + kStartUp + 30.0);
  const Workplace workplace(player);
  Interval interval;
  Usage usage;
  {
    const Daemon daemon(workplace.folder());
    if (!reports_come(listener)) return std::fprintf(stderr, "bench_daemon: no reports came\n"), 2;
    pause(kSettle);
    interval.first = player.newest() + 1;
    interval.begin = wall_ns();
    usage.cpu_s = daemon.cpu();
    pause(arguments.seconds);
    interval.last = player.newest();
    interval.end = wall_ns();
    usage.cpu_s = daemon.cpu() - usage.cpu_s;
    usage.memory_mb = daemon.memory();
    pause(0.2);
    usage.dropped = dropped_here();
  }
  show_bound(arguments, "after");
  listener.end();
  return report(arguments, player, listener, interval, usage);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"odomcalibd under 1 kHz counts and 40 Hz scans of 1081 beams, in real time"};
  Arguments arguments;
  app.add_option("--seconds", arguments.seconds, "length of the measurement")->capture_default_str();
  app.add_flag("--priority", arguments.priority,
               "real-time priority for the daemon and for the devices it talks to");
  CLI11_PARSE(app, argc, argv);
  return measure(arguments);
} catch (const std::exception& error) {
  std::fprintf(stderr, "bench_daemon: %s\n", error.what());
  return 2;
}
