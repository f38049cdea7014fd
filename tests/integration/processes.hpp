// Whole programs under test: started, watched and ended with the test, whatever ends it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace odomcalib::test_support {

/// s of the monotonic clock, the one in the wheel log of odomcalib-sim.
double monotonic();

/// Asks again every `pause` seconds until `condition` holds. @return false when it did not within `seconds`
bool wait_until(const std::function<bool()>& condition, double seconds, double pause = 0.003);

class Process {
 public:
  /// @param output file that takes standard output and standard error
  Process(const std::vector<std::string>& arguments, const std::filesystem::path& output);
  ~Process();  ///< SIGKILL when it still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] pid_t id() const { return pid_; }
  void signal(int number) const;
  void tell(const std::string& line) const;  ///< to its standard input
  /// Exit status, 128 + signal when a signal ended it, nullopt when it still runs after `seconds`.
  std::optional<int> wait(double seconds);
  /// s of processor time that it has used so far.
  [[nodiscard]] double processor_time() const;

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  std::optional<int> status_;
};

struct WheelSpeed {
  double clock = 0.0, simulated = 0.0, rim = 0.0;  ///< s, s, m/s
};

/// Log of the wheels that the simulator has written so far.
class WheelLog {
 public:
  explicit WheelLog(std::filesystem::path path) : path_(std::move(path)) {}
  const std::vector<WheelSpeed>& read();

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::string rest_;
  std::vector<WheelSpeed> speeds_;
};

/// CAN interfaces of both ends; empty: a pseudo-terminal with an slcan adapter between them.
struct CanWiring {
  std::string of_robot, of_daemon;
};

enum class Pace {
  real,    ///< two programs in real time
  hurried  ///< one program (odomcalib-demo) whose time is faster while the robot moves: no wheel log
};

/// Simulator and daemon on a configuration of their own in a temporary folder.
class RobotAndDaemon {
 public:
  explicit RobotAndDaemon(int seed, CanWiring wiring = {}, Pace pace = Pace::real);
  ~RobotAndDaemon();

  void start_daemon();
  [[nodiscard]] bool ready() const;          ///< drive disabled, values read, scans arrive
  [[nodiscard]] std::string status() const;  ///< JSON text, empty when the daemon does not answer
  std::unique_ptr<Process> run(std::vector<std::string> arguments);  ///< odomcalibctl
  [[nodiscard]] std::string output() const;                          ///< of the odomcalibctl started last
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// From `clock` until the rim is below 5 mm/s and stays there for 0.3 s, in simulated s. Waits for it.
  std::optional<double> time_to_rest(double clock);
  /// From `clock` until the rim is slower than this, in simulated s. Waits for it.
  std::optional<double> time_to_slow(double clock, double rim);
  [[nodiscard]] double rim();  ///< m/s, now
  /// s, the longest that the robot's process stood still since `clock`: a drive that sends no heartbeat.
  [[nodiscard]] double longest_pause(double clock);

  std::unique_ptr<Process> robot, daemon;

 private:
  void write_configuration() const;

  [[nodiscard]] std::vector<std::string> robot_command(int seed) const;

  CanWiring wiring_;
  std::filesystem::path folder_;
  std::unique_ptr<WheelLog> wheels_;
  int clients_ = 0;
};

}  // namespace odomcalib::test_support
