// odomcalib-sim: a simulated robot in real time, for demonstrations and for tests of whole programs.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "tests/sim/effects/effect.hpp"
#include "tests/sim/wires/drawn_robot.hpp"
#include "tests/sim/wires/fault_commands.hpp"
#include "tests/sim/wires/truth_json.hpp"

namespace {

using odomcalib::sim::SimRobot;
using odomcalib::sim::SimRobotOptions;

volatile sig_atomic_t stop_requested = 0;

void on_signal(int /*number*/) { stop_requested = 1; }

struct Arguments {
  std::uint64_t seed = 1;
  double speed = 1.0;
  double duration = 0.0;
  std::string room = "furnished";
  std::string link_dir, truth_file, wheel_log, can, effect;
  double effect_size = -1.0;
  bool exact = false, commands = false;
};

std::set<std::string> effect_names() {
  std::set<std::string> names{"random"};
  for (const auto& kind : odomcalib::sim::effect_kinds()) names.insert(kind.name);
  return names;
}

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("--seed", arguments.seed, "robot, noise and random room are drawn from this number");
  app.add_option("--speed", arguments.speed, "times real time")->check(CLI::PositiveNumber);
  app.add_option("--duration", arguments.duration, "simulated seconds, 0 for ever");
  app.add_option("--room", arguments.room, "where it stands")
      ->check(CLI::IsMember({"furnished", "workshop", "corridor", "random"}));
  app.add_option("--link", arguments.link_dir,
                 "folder in which to make the links `can` and `lidar` to the ports");
  app.add_option("--truth", arguments.truth_file,
                 "file to write the true parameters to (JSON), refreshed every second");
  app.add_option("--wheel-log", arguments.wheel_log,
                 "file to append a line to every 2 ms: monotonic clock in s, simulated s, faster rim in m/s, "
                 "angles of both wheels in rad");
  app.add_option("--can", arguments.can, "SocketCAN interface to use instead of an slcan port");
  app.add_option("--effect", arguments.effect,
                 "something that the plain model lacks, e.g. gear_play; random: any")
      ->check(CLI::IsMember(effect_names()));
  app.add_option("--effect-size", arguments.effect_size, "in its unit; default: its largest usual size");
  app.add_flag("--commands", arguments.commands,
               "read faults from standard input, one a line (tests/sim/README.md)");
  app.add_flag("--exact", arguments.exact, "a robot whose true parameters are the nominal ones");
}

odomcalib::sim::Room choose_room(const Arguments& arguments) {
  if (arguments.room == "workshop") return odomcalib::sim::workshop();
  if (arguments.room == "corridor") return odomcalib::sim::corridor();
  if (arguments.room == "random") return odomcalib::sim::random_room(arguments.seed);
  return odomcalib::sim::furnished_room();
}

SimRobotOptions robot_options(const Arguments& arguments, const odomcalib::sim::DrawnEffect& effect) {
  SimRobotOptions options = drawn_robot(arguments.seed, effect);
  if (arguments.exact) options.truth = options.nominal;
  options.room = choose_room(arguments);
  options.link_dir = arguments.link_dir;
  if (!arguments.can.empty()) options.socketcan = arguments.can;
  return options;
}

void announce(const SimRobot& robot) {
  std::printf("can    %s\nlidar  %s\n", robot.can_device().c_str(), robot.lidar_device().c_str());
  std::fflush(stdout);
}

/// Faults that arrived on standard input; never waits.
class CommandReader {
 public:
  CommandReader() { ::fcntl(STDIN_FILENO, F_SETFL, ::fcntl(STDIN_FILENO, F_GETFL) | O_NONBLOCK); }

  void serve(SimRobot& robot) {
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count > 0) pending_.append(bytes.data(), static_cast<std::size_t>(count));
    for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n')) {
      const auto done = odomcalib::sim::apply_command(robot, pending_.substr(0, end));
      if (!done) std::fprintf(stderr, "odomcalib-sim: %s\n", done.error().text().c_str());
      pending_.erase(0, end + 1);
    }
  }

 private:
  std::string pending_;
};

/// True wheel speed over time, complete lines only, for whoever measures how long a stop took.
class WheelLog {
 public:
  explicit WheelLog(const std::string& path)
      : file_(path.empty() ? nullptr : std::fopen(path.c_str(), "we")) {
    if (file_) std::setvbuf(file_.get(), nullptr, _IOLBF, 4096);
  }
  void add(const SimRobot& robot) {
    if (!file_) return;
    const std::chrono::duration<double> clock = std::chrono::steady_clock::now().time_since_epoch();
    const auto& angle = robot.body().angle();
    std::fprintf(file_.get(), "%.6f %.6f %.6f %.8f %.8f\n", clock.count(), robot.now(), robot.fastest_rim(),
                 angle[0], angle[1]);
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

/// @return exit status
int run(SimRobot& robot, const Arguments& arguments, const odomcalib::sim::DrawnEffect& effect) {
  using Clock = std::chrono::steady_clock;
  constexpr double kChunk = 0.002;  // s of real time between exchanges
  const auto start = Clock::now();
  double truth_due = 0.0;
  WheelLog wheel_log(arguments.wheel_log);
  std::optional<CommandReader> commands;
  if (arguments.commands) commands.emplace();
  for (int i = 1; stop_requested == 0; ++i) {
    if (!arguments.truth_file.empty() && robot.now() >= truth_due) {
      const auto written = write_truth(robot, arguments.truth_file, effect);
      if (!written) return std::fprintf(stderr, "odomcalib-sim: %s\n", written.error().text().c_str()), 1;
      truth_due = robot.now() + 1.0;
    }
    // Output of these 2 ms is sent at their end: bytes may come late, never before they were sent.
    std::this_thread::sleep_until(
        start + i * std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kChunk)));
    if (commands) commands->serve(robot);
    robot.step(kChunk * arguments.speed);
    wheel_log.add(robot);
    if (arguments.duration > 0.0 && robot.now() >= arguments.duration) break;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Simulated differential-drive robot: CANopen drive on an slcan port, LD06 lidar on a serial port"};
  Arguments arguments;
  declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  const auto effect = odomcalib::sim::choose_effect(arguments.effect, arguments.seed, arguments.effect_size);
  const auto robot = SimRobot::create(robot_options(arguments, effect));
  if (!robot) {
    std::fprintf(stderr, "odomcalib-sim: %s\n", robot.error().text().c_str());
    return 1;
  }
  announce(*robot.value());
  const int status = run(*robot.value(), arguments, effect);
  if (!arguments.truth_file.empty() && !write_truth(*robot.value(), arguments.truth_file, effect)) return 1;
  return status;
}
