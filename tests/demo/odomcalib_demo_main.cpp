// odomcalib-demo: the service and the simulated robot in one process, on a clock of their own that runs as
// fast as the processor allows while something moves. The service is that of odomcalibd, unmodified; robot
// and service meet at pseudo-terminals, clients at the control socket.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "daemon/config/config.hpp"
#include "daemon/service/calibrator.hpp"
#include "daemon/service/service.hpp"
#include "tests/demo/lease_relay.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/wires/drawn_robot.hpp"
#include "tests/sim/wires/fault_commands.hpp"
#include "tests/sim/wires/truth_json.hpp"

namespace {

using odomcalib::Error;
using odomcalib::Result;
using odomcalib::Service;
using odomcalib::sim::SimRobot;

volatile sig_atomic_t stop_requested = 0;

void on_signal(int /*number*/) { stop_requested = 1; }

constexpr double kStep = 0.002;      // s, between exchanges of bytes
constexpr double kMostBehind = 0.1;  // s of real time that are caught up with

struct Arguments {
  std::string config, folder, effect;
  std::uint64_t seed = 1;
};

double real_now() { return odomcalib::SystemClock().now(); }

/// Begins with the machine's own time; people read that one.
class DemoClock final : public odomcalib::Clock {
 public:
  [[nodiscard]] double now() const override { return time_; }
  [[nodiscard]] std::int64_t wall_us() const override {
    return begin_us_ + static_cast<std::int64_t>((time_ - kBegin) * 1e6);
  }
  void advance(double seconds) { time_ += seconds; }

 private:
  static constexpr double kBegin = 100.0;
  double time_ = kBegin;
  std::int64_t begin_us_ = odomcalib::SystemClock().wall_us();
};

class Demo {
 public:
  Demo(odomcalib::Config config, const Arguments& arguments, std::unique_ptr<SimRobot> robot,
       odomcalib::sim::DrawnEffect effect)
      : config_(std::move(config)),
        truth_(arguments.folder + "/truth.json"),
        robot_(std::move(robot)),
        effect_(std::move(effect)) {}

  Result<void> start() {
    const std::filesystem::path front = config_.socket;
    config_.socket += ".service";
    auto relay = odomcalib::demo::LeaseRelay::create(front, config_.socket);
    if (!relay) return relay.error();
    relay_ = std::move(relay).value();
    return start_service();
  }

  Result<void> run() {
    while (stop_requested == 0) {
      if (auto obeyed = obey(); !obeyed) return obeyed;
      step();
      keep_pace();
    }
    service_->stop_all("the demo ends");
    return {};
  }

 private:
  Result<void> start_service() {
    odomcalib::Calibrator functions = odomcalib::make_calibrator();
    functions.solve = [this, solve = functions.solve](const auto& recordings, const auto& effects,
                                                      const auto& progress) {
      solving_ = true;
      auto result = solve(recordings, effects, progress);
      solving_ = false;
      return result;
    };
    auto service =
        Service::create(config_, clock_, std::move(functions), std::make_unique<odomcalib::Foreground>());
    if (!service) return service.error();
    service_ = std::move(service).value();
    return {};
  }

  void step() {
    robot_->step(kStep);
    clock_.advance(kStep);
    relay_->serve(real_now(), clock_.now());
    service_->poll_once(0);
    relay_->serve(real_now(), clock_.now());
    if (clock_.now() < truth_due_) return;
    truth_due_ = clock_.now() + 0.2;
    (void)odomcalib::sim::write_truth(*robot_, truth_, effect_);
  }

  /// While nobody drives, or a solver computes, nothing is gained by haste: then a step takes as long as it
  /// says.
  void keep_pace() {
    const double now = real_now();
    const bool hurries = relay_->leased() && !solving_;
    due_ = hurries ? now : std::max(due_ + kStep, now - kMostBehind);
    if (due_ > now) poll(nullptr, 0, static_cast<int>(std::ceil(1e3 * (due_ - now))));
  }

  /// Lines on standard input: faults of the simulated robot, and `power cycle` of robot and service.
  Result<void> obey() {
    std::array<char, 256> bytes{};
    const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count > 0) pending_.append(bytes.data(), static_cast<std::size_t>(count));
    for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n')) {
      const std::string line = pending_.substr(0, end);
      pending_.erase(0, end + 1);
      if (line == "power cycle") {
        robot_->reset_drive();
        relay_->drop_all();
        service_.reset();
        if (auto started = start_service(); !started) return started;
      } else if (auto done = apply_command(*robot_, line); !done) {
        std::fprintf(stderr, "odomcalib-demo: %s\n", done.error().text().c_str());
      }
    }
    return {};
  }

  odomcalib::Config config_;
  std::string truth_;
  std::unique_ptr<SimRobot> robot_;
  odomcalib::sim::DrawnEffect effect_;
  DemoClock clock_;
  std::atomic<bool> solving_ = false;
  std::unique_ptr<Service> service_;
  std::unique_ptr<odomcalib::demo::LeaseRelay> relay_;
  std::string pending_;
  double truth_due_ = 0.0;  // s of the service's time
  double due_ = 0.0;        // s of real time
};

Result<void> run(const Arguments& arguments) {
  const auto effect = odomcalib::sim::choose_effect(arguments.effect, arguments.seed);
  auto options = odomcalib::sim::drawn_robot(arguments.seed, effect);
  options.link_dir = arguments.folder + "/ports";
  auto robot = SimRobot::create(options);
  if (!robot) return robot.error();
  const auto config = odomcalib::read_config(arguments.config);
  if (!config) return config.error();
  Demo demo(config.value(), arguments, std::move(robot).value(), effect);
  if (auto started = demo.start(); !started) return started;
  return demo.run();
}

/// @return exit status
int run(int argc, char** argv) {
  CLI::App app{"The service and a simulated robot, faster than real time"};
  Arguments arguments;
  app.add_option("--config", arguments.config, "the service's configuration file")->required();
  app.add_option("--folder", arguments.folder, "for the ports of the robot (in ports/) and its truth.json")
      ->required();
  app.add_option("--seed", arguments.seed, "robot and noise are drawn from this number");
  app.add_option("--effect", arguments.effect,
                 "something that the plain model lacks; random: any; absent: none");
  CLI11_PARSE(app, argc, argv);
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  fcntl(STDIN_FILENO, F_SETFL, fcntl(STDIN_FILENO, F_GETFL) | O_NONBLOCK);
  const auto done = run(arguments);
  if (done) return 0;
  std::fprintf(stderr, "odomcalib-demo: %s\n", done.error().text().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "odomcalib-demo: %s\n", error.what());
    return 1;
  }
}
