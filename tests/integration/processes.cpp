#include "tests/integration/processes.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "daemon/cli/client.hpp"

namespace odomcalib::test_support {
namespace {

constexpr double kRest = 0.005;   // m/s
constexpr double kStays = 0.3;    // s
constexpr double kPatience = 10;  // s

// The simulated robot must keep its times on a busy machine, and take none from the daemon: a real one has a
// processor of its own. Without the right to this the test runs anyway.
void hurry(const std::string& program) {
  const sched_param priority{.sched_priority = program == ODOMCALIB_DAEMON ? 10 : 9};
  (void)sched_setscheduler(0, SCHED_RR, &priority);
}

[[noreturn]] void become(const std::vector<std::string>& arguments, int input, int output) {
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  hurry(arguments.front());
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(words.front(), words.data());
  _exit(127);
}

}  // namespace

double monotonic() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool wait_until(const std::function<bool()>& condition, double seconds, double pause) {
  for (const double end = monotonic() + seconds; monotonic() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
  }
  return condition();
}

Process::Process(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
  const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  pid_ = fork();
  if (pid_ == 0) become(arguments, ends[0], file);
  close(ends[0]);
  close(file);
  input_ = ends[1];
}

Process::~Process() {
  if (!wait(0.0)) {
    signal(SIGKILL);
    (void)wait(kPatience);
  }
  if (input_ >= 0) close(input_);
}

void Process::signal(int number) const {
  if (pid_ > 0 && !status_) kill(pid_, number);
}

void Process::tell(const std::string& line) const {
  const std::string text = line + "\n";
  (void)!write(input_, text.data(), text.size());
}

std::optional<int> Process::wait(double seconds) {
  const auto ended = [this] {
    int status = 0;
    if (status_ || pid_ <= 0) return true;
    if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return true;
  };
  (void)wait_until(ended, seconds);
  return status_;
}

double Process::processor_time() const {
  clockid_t clock = 0;
  timespec used{};
  if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &used) != 0) return 0.0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

const std::vector<WheelSpeed>& WheelLog::read() {
  if (!file_.is_open()) file_.open(path_);
  file_.clear();
  for (std::string line; std::getline(file_, line);) {
    if (file_.eof()) {  // half a line: its end comes later
      rest_ += line;
      break;
    }
    WheelSpeed speed;
    std::istringstream(rest_ + line) >> speed.clock >> speed.simulated >> speed.rim;
    rest_.clear();
    speeds_.push_back(speed);
  }
  return speeds_;
}

RobotAndDaemon::RobotAndDaemon(int seed, CanWiring wiring, Pace pace) : wiring_(std::move(wiring)) {
  std::string name = "/tmp/odomcalib-pt-XXXXXX";
  folder_ = mkdtemp(name.data());
  std::filesystem::create_directory(folder_ / "ports");
  wheels_ = std::make_unique<WheelLog>(folder_ / "wheels");
  if (pace == Pace::hurried) {
    write_configuration();
    robot = std::make_unique<Process>(
        std::vector<std::string>{ODOMCALIB_DEMO, "--seed", std::to_string(seed), "--folder", folder_,
                                 "--config", folder_ / "odomcalib.toml"},
        folder_ / "robot.log");
    return;
  }
  robot = std::make_unique<Process>(robot_command(seed), folder_ / "robot.log");
  (void)wait_until([this] { return std::filesystem::exists(folder_ / "ports" / "lidar"); }, kPatience);
  write_configuration();
  start_daemon();
}

std::vector<std::string> RobotAndDaemon::robot_command(int seed) const {
  std::vector<std::string> words{ODOMCALIB_SIM,      "--seed",    std::to_string(seed),   "--link",
                                 folder_ / "ports",  "--truth",   folder_ / "truth.json", "--wheel-log",
                                 folder_ / "wheels", "--commands"};
  if (!wiring_.of_robot.empty()) words.insert(words.end(), {"--can", wiring_.of_robot});
  return words;
}

RobotAndDaemon::~RobotAndDaemon() {
  daemon.reset();
  robot.reset();
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void RobotAndDaemon::write_configuration() const {
  const std::string ports = folder_ / "ports";
  const std::string can =
      wiring_.of_daemon.empty() ? "slcan:" + ports + "/can?bitrate=500000" : "socketcan:" + wiring_.of_daemon;
  std::ofstream(folder_ / "odomcalib.toml")
      << "[controller]\ndevice = \"" << can << "\"\nprofile = \"" << ODOMCALIB_PROFILE
      << "\"\n[lidar]\ndevice = \"serial:" << ports << "/lidar?baud=230400\"\npose = [0.10, 0.0, 0.0]\n"
      << "[robot]\nwheel_diameter = 0.150\ntrack_width = 0.400\n[limits]\ncountdown = 0.0\n"
      << "[lcm]\nenabled = false\n[daemon]\nstate_dir = \"" << (folder_ / "state").string()
      << "\"\nsocket = \"" << (folder_ / "control").string() << "\"\n";
}

void RobotAndDaemon::start_daemon() {
  daemon = std::make_unique<Process>(
      std::vector<std::string>{ODOMCALIB_DAEMON, "--config", folder_ / "odomcalib.toml"},
      folder_ / "daemon.log");
}

std::string RobotAndDaemon::status() const {
  auto client = cli::Client::connect(folder_ / "control");
  if (!client) return "";
  const auto answer = client.value().call("GetStatus");
  if (!answer) return "";
  return nlohmann::json(answer.value())["status"].dump();
}

bool RobotAndDaemon::ready() const {
  const auto now = nlohmann::json::parse(status(), nullptr, false);
  return now.is_object() && now["controller"]["state"] == "disabled" && now["state"] == "idle" &&
         now["robot"]["in_controller"] == true && now["lidar"]["stale"] == "" &&
         now["controller"]["stale"] == "";
}

std::unique_ptr<Process> RobotAndDaemon::run(std::vector<std::string> arguments) {
  const std::vector<std::string> head{ODOMCALIB_CTL, "--socket", folder_ / "control"};
  arguments.insert(arguments.begin(), head.begin(), head.end());
  return std::make_unique<Process>(arguments, folder_ / ("client" + std::to_string(++clients_)));
}

std::string RobotAndDaemon::output() const {
  std::ifstream file(folder_ / ("client" + std::to_string(clients_)));
  return {std::istreambuf_iterator<char>(file), {}};
}

double RobotAndDaemon::rim() {
  const auto& speeds = wheels_->read();
  return speeds.empty() ? 0.0 : speeds.back().rim;
}

double RobotAndDaemon::longest_pause(double clock) {
  double longest = 0.0, before = clock;
  for (const WheelSpeed& speed : wheels_->read()) {
    if (speed.clock <= clock) continue;
    longest = std::max(longest, speed.clock - before);
    before = speed.clock;
  }
  return longest;
}

std::optional<double> RobotAndDaemon::time_to_slow(double clock, double rim) {
  std::optional<double> time;
  const auto slow = [&] {
    double begin = 0.0;
    for (const WheelSpeed& speed : wheels_->read()) {
      if (speed.clock <= clock) begin = speed.simulated;
      if (speed.clock > clock && speed.rim < rim && !time) time = speed.simulated - begin;
    }
    return time.has_value();
  };
  (void)wait_until(slow, kPatience, 0.05);
  return time;
}

std::optional<double> RobotAndDaemon::time_to_rest(double clock) {
  std::optional<double> rest;
  double begin = 0.0;
  const auto stands = [&] {
    rest.reset();
    for (const WheelSpeed& speed : wheels_->read()) {
      if (speed.clock <= clock) begin = speed.simulated;
      if (speed.clock <= clock) continue;
      if (speed.rim >= kRest)
        rest.reset();
      else if (!rest)
        rest = speed.simulated;
    }
    return rest && wheels_->read().back().simulated - *rest > kStays;
  };
  if (!wait_until(stands, kPatience, 0.05)) return std::nullopt;
  return *rest - begin;
}

}  // namespace odomcalib::test_support
