#include "daemon/service/solver_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/service/settings.hpp"
#include "daemon/service/urgency.hpp"
#include "proto/control/control.hpp"

namespace odomcalib {
namespace {

constexpr int kAnswers = 3;  // descriptor of the solver: replies as on the control socket
constexpr rlim_t kMiB = 1U << 20U;

#if defined(ODOMCALIB_SANITIZED)
constexpr bool kMemoryLimited = false;  // their shadow of the memory counts as data
#else
constexpr bool kMemoryLimited = true;
#endif

Error no_process(const std::string& what) {
  return {ErrorCode::io, what, "solver", "the recording is kept: odomcalibctl solve"};
}

std::string description(int status) {
  if (!WIFSIGNALED(status)) return fmt::format("ended with status {}", WEXITSTATUS(status));
  return fmt::format("was killed by signal {}", WTERMSIG(status));
}

/// A started program and what it answers. It does not outlive this.
class Child {
 public:
  Child() = default;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      (void)wait();
    }
    if (answers_ >= 0) close(answers_);
  }

  Result<void> start(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  [[nodiscard]] int answers() const { return answers_; }
  /// Status as of waitpid.
  int wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
  int answers_ = -1;
};

Result<void> Child::start(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return no_process(std::strerror(errno));
  answers_ = ends[0];
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (const std::string& one : arguments) pointers.push_back(const_cast<char*>(one.c_str()));
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], kAnswers);
  posix_spawn_file_actions_addclosefrom_np(&actions, kAnswers + 1);
  const int problem = posix_spawn(&pid_, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (problem == 0) return {};
  pid_ = -1;
  return no_process("cannot start the solver: " + std::string(std::strerror(problem)));
}

struct Progress {
  std::string phase = "reading";
  double fraction = 0.0;
};

Result<Calibration> calibration_of(const control::Reply& reply) {
  const auto parameters = nlohmann::json::parse(reply.parameters, nullptr, false);
  const auto text = parameters.find("calibration");
  if (text == parameters.end() || !text->is_string()) return no_process("the solver answers otherwise");
  return calibration_from_json(text->get<std::string>(), "solver");
}

Progress progress_of(const control::Reply& reply) {
  const auto parameters = nlohmann::json::parse(reply.parameters, nullptr, false);
  return {parameters.value("phase", ""), parameters.value("fraction", 0.0)};
}

/// Replies up to the last one, or the end of the solver.
class Answers {
 public:
  explicit Answers(int fd) : fd_(fd) {}
  /// Whatever came within 0.1 s; false: there is no more.
  bool listen() {
    pollfd one{.fd = fd_, .events = POLLIN, .revents = 0};
    if (poll(&one, 1, service::settings::kAskedAgain_ms) <= 0) return true;
    std::array<char, 65536> bytes;
    const ssize_t count = read(fd_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) return true;
    if (count > 0) decoder_.feed({bytes.data(), static_cast<std::size_t>(count)});
    return count > 0;
  }
  std::optional<control::Reply> next() {
    const auto frame = decoder_.next();
    if (!frame) return std::nullopt;
    auto reply = control::decode_reply(*frame);
    return reply ? std::optional(std::move(reply).value()) : std::nullopt;
  }

 private:
  int fd_;
  control::FrameDecoder decoder_;
};

/// @return nullopt: it ended without one
std::optional<Result<Calibration>> follow(Answers& answers, const Calibrator::Progress& progress) {
  Progress last;
  for (bool more = true; more;) {
    more = answers.listen();
    while (const auto reply = answers.next()) {
      if (!reply->error.empty()) return control::error_of(*reply);
      if (!reply->continues) return calibration_of(*reply);
      last = progress_of(*reply);
    }
    if (progress) progress(last.phase, last.fraction);
  }
  return std::nullopt;
}

std::vector<std::string> arguments_of(const SolverProcess& process,
                                      const std::vector<std::filesystem::path>& recordings,
                                      const std::vector<std::string>& effects) {
  std::vector<std::string> all{"odomcalibd", "--solver-memory", std::to_string(process.memory)};
  for (const auto& path : recordings) all.insert(all.end(), {"--solve", path.string()});
  for (const auto& effect : effects) all.insert(all.end(), {"--effect", effect});
  return all;
}

void limit_own_means(std::uint32_t memory) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  step_back();
  std::ofstream("/proc/self/oom_score_adj") << 1000;  // where memory is short for all, this one goes first
  const rlim_t bytes = memory * kMiB;
  const rlimit limit{.rlim_cur = bytes, .rlim_max = bytes};
  if (kMemoryLimited) (void)setrlimit(RLIMIT_DATA, &limit);
}

bool answer(const std::string& frame) {
  for (std::string_view rest = frame; !rest.empty();) {
    const ssize_t count = write(kAnswers, rest.data(), rest.size());
    if (count < 0) return false;
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

Result<Calibration> solved_alone(const Calibrator::Solve& solve,
                                 const std::vector<std::filesystem::path>& recordings,
                                 const std::vector<std::string>& effects, std::uint32_t memory) {
  const auto tell = [](const std::string& phase, double fraction) {
    (void)answer(
        control::encode_reply(nlohmann::json{{"phase", phase}, {"fraction", fraction}}.dump(), true));
  };
  try {
    return solve(recordings, effects, tell);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::io, fmt::format("the solver needs more than its {} MiB of memory", memory),
                 recordings.back().string(), "solve it elsewhere: odomcalibctl solve"};
  } catch (const std::exception& error) {
    return Error{ErrorCode::format, error.what(), recordings.back().string(), "report this recording"};
  }
}

}  // namespace

Calibrator::Solve solve_in_process(const SolverProcess& process) {
  return
      [process](const std::vector<std::filesystem::path>& recordings, const std::vector<std::string>& effects,
                const Calibrator::Progress& progress) -> Result<Calibration> {
        Child child;
        const auto started = child.start(process.program, arguments_of(process, recordings, effects));
        if (!started) return started.error();
        Answers answers(child.answers());
        if (auto solution = follow(answers, progress)) return *std::move(solution);
        return no_process("the solver " + description(child.wait()));
      };
}

int answer_with_solution(const Calibrator::Solve& solve, const std::vector<std::filesystem::path>& recordings,
                         const std::vector<std::string>& effects, std::uint32_t memory) {
  limit_own_means(memory);
  const auto solution = solved_alone(solve, recordings, effects, memory);
  if (!solution) return answer(control::encode_error(solution.error())) ? 0 : 1;
  const nlohmann::json parameters{{"calibration", to_json(solution.value())}};
  return answer(control::encode_reply(parameters.dump())) ? 0 : 1;
}

}  // namespace odomcalib
