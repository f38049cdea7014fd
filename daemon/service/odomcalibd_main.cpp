// odomcalibd: reads the configuration, runs the loop, talks to systemd.
#include <signal.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>

#include "daemon/service/service.hpp"
#include "odomcalib_version.hpp"

namespace {

using odomcalib::Service;

volatile sig_atomic_t stop_requested = 0;

void on_signal(int /*number*/) { stop_requested = 1; }

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaction(number, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

// Fed from the loop itself: a loop that hangs starves it.
class Watchdog {
 public:
  Watchdog() { enabled_ = sd_watchdog_enabled(0, &interval_us_) > 0; }
  void turned(double now, const Service& service) {
    if (now < next_) return;
    next_ = now + (enabled_ ? 0.5e-6 * static_cast<double>(interval_us_) : 1.0);
    const std::string text = (enabled_ ? "WATCHDOG=1\nSTATUS=" : "STATUS=") + service.status_line();
    sd_notify(0, text.c_str());
  }

 private:
  std::uint64_t interval_us_ = 0;
  bool enabled_ = false;
  double next_ = 0.0;
};

constexpr double kShortestEnd = 0.25;  // s; at rest the axes are off after 0.1
constexpr double kLongestEnd = 1.5;    // s, until the wheels stand
constexpr double kLongestWrite = 8.0;  // s, until a write-back has ended; below the unit's TimeoutStopSec

// The controller sends the stop again and takes the torque off before the bus is closed, from motion after
// the ramp; and it gets all values of a write-back, or its old ones back.
bool may_end(const Service& service, double elapsed) {
  if (elapsed < kShortestEnd) return false;
  if (elapsed < kLongestEnd && !service.drive_off()) return false;
  return elapsed >= kLongestWrite || !service.writing();
}

void run(Service& service, const odomcalib::Clock& clock) {
  Watchdog watchdog;
  sd_notify(0, "READY=1");
  while (stop_requested == 0) {
    service.poll_once(20);
    watchdog.turned(clock.now(), service);
  }
  service.stop_all("the daemon was told to end");
  sd_notify(0, "STOPPING=1");
  for (const double begin = clock.now(); !may_end(service, clock.now() - begin);) {
    service.poll_once(5);
    watchdog.turned(clock.now(), service);
  }
}

int serve(const std::string& path) {
  const auto config = odomcalib::read_config(path);
  if (!config) {
    spdlog::error("{}", config.error().text());
    return 2;
  }
  odomcalib::SystemClock clock;
  auto service = Service::create(config.value(), clock, odomcalib::make_calibrator());
  if (!service) {
    spdlog::error("{}", service.error().text());
    return 1;
  }
  spdlog::info("odomcalibd {} serves {}", odomcalib::kVersion, config.value().socket.string());
  run(*service.value(), clock);
  service.value().reset();
  spdlog::info("ended");
  return 0;
}

int run(int argc, char** argv) {
  CLI::App app{"Calibrates the odometry of a differential-drive robot: the service on the robot.",
               "odomcalibd"};
  std::string config = "/etc/odomcalib/odomcalib.toml";
  app.add_option("--config", config, "configuration file")->capture_default_str();
  app.set_version_flag("--version", odomcalib::kVersion);
  CLI11_PARSE(app, argc, argv);
  spdlog::set_pattern("%l: %v");
  catch_signals();
  return serve(config);
}

}  // namespace

int main(int argc, char** argv) {
  int status = 1;
  try {
    status = run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
  }
  // A solve that still runs in its thread ends with the process.
  std::fflush(nullptr);
  _exit(status);
}
