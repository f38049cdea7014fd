// odomcalibd: reads the configuration, runs the loop, talks to systemd.
#include <signal.h>
#include <spdlog/spdlog.h>
#include <syslog.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-journal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "daemon/config/large_pages.hpp"
#include "daemon/service/base_link.hpp"
#include "daemon/service/disk_worker.hpp"
#include "daemon/service/lidar_link.hpp"
#include "daemon/service/quick_stop.hpp"
#include "daemon/service/service.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/solver_process.hpp"
#include "daemon/service/urgency.hpp"
#include "odomcalib_paths.hpp"
#include "odomcalib_version.hpp"
#include "proto/visible_text.hpp"

namespace {

using odomcalib::Service;
namespace settings = odomcalib::service::settings;

volatile sig_atomic_t stop_requested = 0, hung_up = 0;

void on_signal(int number) {
  if (number == SIGHUP)
    hung_up = 1;
  else
    stop_requested = 1;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaction(number, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

// With the kind of event as a field of its own where this program's messages go to systemd's journal.
void write_event(odomcalib::messages::Severity severity, const std::string& code,
                 const std::string& happened) {
  const std::string text = odomcalib::visible(happened);  // devices and clients have their say in it
  using Severity = odomcalib::messages::Severity;
  const bool in_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  const bool info = severity == Severity::info, fault = severity == Severity::fault;
  const auto level = info ? spdlog::level::info : fault ? spdlog::level::err : spdlog::level::warn;
  if (!in_journal) return spdlog::log(level, "{}: {}", code, text);
  (void)sd_journal_send("MESSAGE=%s: %s", code.c_str(), text.c_str(), "PRIORITY=%i",
                        info    ? LOG_INFO
                        : fault ? LOG_ERR
                                : LOG_WARNING,
                        "ODOMCALIB_EVENT=%s", code.c_str(), nullptr);
}

// Beside the loop: a journal whose disk is slow must not hold it up.
class Log {
 public:
  void write(odomcalib::messages::Severity severity, const std::string& code, const std::string& text) {
    worker_.post([severity, code, text] { write_event(severity, code, text); }, [] {});
  }
  void serve() { worker_.serve(); }
  void finish() { worker_.finish(); }

 private:
  odomcalib::DiskWorker worker_;
};

// Messages to systemd. Requested by the loop itself: a loop that hangs requests none. Sent beside it: a
// manager that is busy takes messages late.
class Watchdog {
 public:
  Watchdog() { enabled_ = sd_watchdog_enabled(0, &interval_us_) > 0; }
  void tell(const std::string& text) {
    worker_.post([text] { sd_notify(0, text.c_str()); }, [] {});
  }
  void turned(double now, const Service& service) {
    worker_.serve();
    if (now < next_ || under_way_) return;
    next_ = now + (enabled_ ? 0.5e-6 * static_cast<double>(interval_us_) : settings::kStatusLine_s);
    under_way_ = true;
    const std::string text = (enabled_ ? "WATCHDOG=1\nSTATUS=" : "STATUS=") + service.status_line();
    worker_.post([text] { sd_notify(0, text.c_str()); }, [this] { under_way_ = false; });
  }

 private:
  std::uint64_t interval_us_ = 0;
  bool enabled_ = false;
  bool under_way_ = false;  // the last one is still on its way
  double next_ = 0.0;
  odomcalib::DiskWorker worker_;  // last: what its work uses exists
};

// The controller sends the stop again and takes the torque off before the bus is closed, from motion after
// the ramp; and it gets all values of a write-back, or its old ones back.
bool may_end(const Service& service, double elapsed) {
  if (elapsed < settings::kShortestEnd_s) return false;
  if (elapsed < settings::kLongestEnd_s && !service.drive_off()) return false;
  return elapsed >= settings::kLongestWrite_s || !service.writing();
}

// A robot that may move is not configured anew, and a service does not end because somebody logs out.
void refuse_to_reload(Log& log) {
  if (hung_up == 0) return;
  hung_up = 0;
  log.write(odomcalib::messages::Severity::warning, "hangup",
            "SIGHUP changes nothing: the configuration is read at the start; systemctl restart odomcalib");
}

void run(Service& service, const odomcalib::Clock& clock, Log& log) {
  Watchdog watchdog;
  watchdog.tell("READY=1");
  while (stop_requested == 0) {
    service.poll_once(settings::kTurn_ms);
    refuse_to_reload(log);
    log.serve();
    watchdog.turned(clock.now(), service);
  }
  service.stop_all("the daemon ends");
  watchdog.tell("STOPPING=1");
  for (const double begin = clock.now(); !may_end(service, clock.now() - begin);) {
    service.poll_once(settings::kEndingTurn_ms);
    log.serve();
    watchdog.turned(clock.now(), service);
  }
}

constexpr int kFailure = 1, kUsage = 2;  // odomcalibd(8), "EXIT STATUS"

// Some of these errors know the value only, or nothing.
odomcalib::Error at_key(odomcalib::Error error, const std::string& key) {
  if (!error.where.starts_with("controller."))
    error.where = key + (error.where.empty() ? "" : ": ") + error.where;
  return error;
}

// Devices may be absent; profile, lidar type and the form of both addresses may not be wrong.
odomcalib::Result<void> check_devices(const odomcalib::Config& config) {
  if (auto base = odomcalib::BaseLink::create(config.controller_device, config.controller_profile); !base)
    return at_key(base.error(), "controller.profile");
  if (auto lidar = odomcalib::LidarLink::create(config.lidar_device, config.lidar_type); !lidar)
    return at_key(lidar.error(), "lidar");
  return {};
}

// Names the file too: an error of a device knows only its key.
int refuse(const odomcalib::Error& error, const std::string& path) {
  spdlog::error("configuration {}: {}", path, error.text());
  return kUsage;
}

// Whoever reads the journal sees that scans depend on a name service; a name that has no address is told
// later, as whatever else keeps the lidar away.
void log_host_name(const odomcalib::Config& config) {
  const auto lidar = odomcalib::LidarLink::create(config.lidar_device, config.lidar_type);
  if (lidar && !lidar.value().host_name().empty())
    spdlog::info(
        "lidar.device has the name of a host, {}: it is looked up before each connection; an address in "
        "numbers needs no name service",
        lidar.value().host_name());
}

int serve(const std::string& path) {
  const auto config = odomcalib::read_config(path);
  if (!config) return refuse(config.error(), path);
  if (const auto devices = check_devices(config.value()); !devices) return refuse(devices.error(), path);
  const auto urgency = odomcalib::made_urgent();
  odomcalib::SystemClock clock;
  auto calibrator = odomcalib::make_calibrator();
  calibrator.solve = odomcalib::solve_in_process({});
  Log log;
  auto service = Service::create(
      config.value(), clock, calibrator, nullptr,
      [&log](auto severity, const auto& code, const auto& text) { log.write(severity, code, text); },
      urgency);
  if (!service) {
    spdlog::error("{}", service.error().text());
    return kFailure;
  }
  spdlog::info("odomcalibd {} serves {}", odomcalib::kVersion, config.value().socket.string());
  log_host_name(config.value());
  run(*service.value(), clock, log);
  service.value().reset();
  log.finish();
  spdlog::info("ended");
  return 0;
}

int stop_only(const std::string& path) {
  const auto config = odomcalib::read_config(path);
  if (!config) return refuse(config.error(), path);
  const auto stopped = odomcalib::quick_stop(config.value(), odomcalib::SystemClock());
  if (stopped) return 0;
  spdlog::warn("no quick stop was sent: {}", stopped.error().text());
  return kFailure;
}

int run(int argc, char** argv) {
  CLI::App app{"Calibrates the odometry of a differential-drive robot: the service on the robot.",
               "odomcalibd"};
  std::string config = odomcalib::kConfigFile;
  app.add_option("--config", config, "configuration file")->capture_default_str();
  bool only_stop = false;
  app.add_flag("--quick-stop", only_stop,
               "stop the wheels and end: for the time after a daemon that has ended");
  // For this program itself: solver_process.hpp.
  std::vector<std::filesystem::path> recordings;
  std::vector<std::string> effects;
  odomcalib::SolverProcess solver;
  app.add_option("--solve", recordings)->group("");
  app.add_option("--effect", effects)->group("");
  app.add_option("--solver-memory", solver.memory)->group("");
  app.set_version_flag("--version", odomcalib::kVersion);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  spdlog::set_pattern("%l: %v");
  if (!recordings.empty()) {
    odomcalib::ask_for_large_pages(argv);
    return odomcalib::answer_with_solution(odomcalib::make_calibrator().solve, recordings, effects,
                                           solver.memory);
  }
  catch_signals();
  return only_stop ? stop_only(config) : serve(config);
}

}  // namespace

int main(int argc, char** argv) {
  int status = kFailure;
  try {
    status = run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
  }
  // A thread that still waits for the solver ends with the process, and the solver with the thread.
  std::fflush(nullptr);
  _exit(status);
}
