#include "tests/integration/call_watch.hpp"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>

namespace odomcalib::test_support {
namespace {

constexpr int kLongestPoll_ms = 20;  // of a turn at rest
constexpr int kDrain = 0x5409;       // TCSBRK: tcdrain()

/// Kinds of calls, by how their arguments show whether they may wait.
enum class Kind { always, by_descriptor, by_message_flags, open, wait, lock, poll, poll_for, drain };
struct Call {
  const char* name;
  Kind kind;
};

const std::map<int, Call>& watched() {
  static const std::map<int, Call> calls = {
    {SYS_fsync, {"fsync", Kind::always}},
    {SYS_fdatasync, {"fdatasync", Kind::always}},
    {SYS_sync, {"sync", Kind::always}},
    {SYS_syncfs, {"syncfs", Kind::always}},
    {SYS_nanosleep, {"nanosleep", Kind::always}},
    {SYS_clock_nanosleep, {"clock_nanosleep", Kind::always}},
    {SYS_pselect6, {"pselect6", Kind::always}},
    {SYS_connect, {"connect", Kind::by_descriptor}},
    {SYS_accept4, {"accept4", Kind::by_descriptor}},
    {SYS_read, {"read", Kind::by_descriptor}},
    {SYS_write, {"write", Kind::by_descriptor}},
    {SYS_writev, {"writev", Kind::by_descriptor}},
    {SYS_sendto, {"sendto", Kind::by_message_flags}},
    {SYS_sendmsg, {"sendmsg", Kind::by_message_flags}},
    {SYS_recvfrom, {"recvfrom", Kind::by_message_flags}},
    {SYS_recvmsg, {"recvmsg", Kind::by_message_flags}},
    {SYS_openat, {"openat", Kind::open}},
    {SYS_wait4, {"wait4", Kind::wait}},
    {SYS_flock, {"flock", Kind::lock}},
    {SYS_ioctl, {"ioctl", Kind::drain}},
#if defined(SYS_poll)
    {SYS_poll, {"poll", Kind::poll}},
    {SYS_select, {"select", Kind::always}},
#endif
    {SYS_ppoll, {"ppoll", Kind::poll_for}},
  };
  return calls;
}

std::vector<sock_filter> filter() {
  std::vector<sock_filter> program = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const auto& [number, call] : watched()) {
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<__u32>(number), 0, 1));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF));
  }
  program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  return program;
}

/// In the new process: the kernel shows these calls to whoever has the descriptor that is returned.
int install() {
  auto program = filter();
  const sock_fprog described{static_cast<unsigned short>(program.size()), program.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return -1;
  return static_cast<int>(
      syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &described));
}

std::string path_of(pid_t pid, int fd) {
  std::error_code ignored;
  const auto path = "/proc/" + std::to_string(pid) + "/fd/" + std::to_string(fd);
  return std::filesystem::read_symlink(path, ignored).string();
}

/// Whether a descriptor makes callers wait: it is no file on a disk, and was not opened to return at once.
bool blocks(pid_t pid, int fd) {
  const std::string of_process = "/proc/" + std::to_string(pid);
  struct stat status {};
  if (stat((of_process + "/fd/" + std::to_string(fd)).c_str(), &status) != 0) return false;
  if (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) return false;
  std::ifstream info(of_process + "/fdinfo/" + std::to_string(fd));
  for (std::string word; info >> word;)
    if (word == "flags:" && info >> word) return (std::stoul(word, nullptr, 8) & O_NONBLOCK) == 0;
  return false;
}

template <typename Value>
std::optional<Value> memory(pid_t pid, std::uint64_t address) {
  Value value{};
  iovec here{&value, sizeof value}, there{reinterpret_cast<void*>(address), sizeof value};
  if (process_vm_readv(pid, &here, 1, &there, 1, 0) != static_cast<ssize_t>(sizeof value))
    return std::nullopt;
  return value;
}

std::string text_at(pid_t pid, std::uint64_t address) {
  std::string text;
  for (auto letter = memory<char>(pid, address); letter && *letter != '\0' && text.size() < 4096;
       letter = memory<char>(pid, ++address))
    text += *letter;
  return text;
}

/// A device that may make callers wait, or a file that only somebody who looks up users, groups or hosts
/// opens.
bool waits_to_open(const std::string& path, std::uint64_t flags) {
  for (const char* of_directory :
       {"/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/hosts", "/etc/resolv.conf"})
    if (path == of_directory) return true;
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return false;
  constexpr unsigned kMemory = 1;  // null, zero, urandom ...
  const bool device =
      S_ISFIFO(status.st_mode) || (S_ISCHR(status.st_mode) && major(status.st_rdev) != kMemory);
  return device && (flags & O_NONBLOCK) == 0;
}

std::string shown(const Call& call, const std::string& what) {
  return std::string(call.name) + "(" + what + ")";
}

/// The call with what it may wait for; nullopt: it waits for nothing.
std::optional<std::string> may_wait(const Call& call, pid_t pid, const seccomp_data& data) {
  const int fd = static_cast<int>(data.args[0]);
  const auto given = [&](bool waits, const std::string& what) {
    return waits ? std::optional(shown(call, what)) : std::nullopt;
  };
  switch (call.kind) {
    case Kind::by_descriptor:
      return given(blocks(pid, fd), path_of(pid, fd));
    case Kind::by_message_flags: {
      const std::uint64_t flags =
          data.nr == SYS_sendmsg || data.nr == SYS_recvmsg ? data.args[2] : data.args[3];
      return given((flags & MSG_DONTWAIT) == 0 && blocks(pid, fd), path_of(pid, fd));
    }
    case Kind::open: {
      const std::string path = text_at(pid, data.args[1]);
      return given(waits_to_open(path, data.args[2]), path);
    }
    case Kind::wait:
      return given((data.args[2] & WNOHANG) == 0, "a process");
    case Kind::lock:
      return given((data.args[1] & LOCK_NB) == 0, path_of(pid, fd));
    case Kind::drain:
      return given(data.args[1] == kDrain, path_of(pid, fd));
    case Kind::poll: {
      const int limit = static_cast<int>(data.args[2]);
      return given(limit < 0 || limit > kLongestPoll_ms, std::to_string(limit) + " ms");
    }
    case Kind::poll_for: {
      const auto limit = memory<timespec>(pid, data.args[2]);
      return given(!limit || limit->tv_sec > 0 || limit->tv_nsec > kLongestPoll_ms * 1'000'000L, "longer");
    }
    case Kind::always:
      break;
  }
  return shown(call, "");
}

}  // namespace

CallWatch::CallWatch(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  std::array<int, 2> numbers{}, gate{};
  if (pipe2(numbers.data(), O_CLOEXEC) != 0 || pipe2(gate.data(), O_CLOEXEC) != 0) return;
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    close(gate[1]);
    // The number of the listener is told by a call that is not watched, and kept until somebody else has it.
    int listener = install();
    const iovec number{&listener, sizeof listener};
    (void)!syscall(SYS_pwritev2, numbers[1], &number, 1, -1L, -1L, 0);
    char none = 0;
    (void)!read(gate[0], &none, 1);
    execv(words.front(), words.data());
    _exit(127);
  }
  close(numbers[1]);
  close(gate[0]);
  int theirs = -1;
  if (read(numbers[0], &theirs, sizeof theirs) != static_cast<ssize_t>(sizeof theirs)) theirs = -1;
  const int process = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (theirs >= 0 && process >= 0) listener_ = static_cast<int>(syscall(SYS_pidfd_getfd, process, theirs, 0));
  if (listener_ < 0)
    unable_ = std::string("the kernel does not show calls to this process: ") + std::strerror(errno);
  if (process >= 0) close(process);
  if (listener_ >= 0) thread_ = std::thread([this] { serve(); });
  close(numbers[0]);
  close(gate[1]);
}

CallWatch::~CallWatch() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  ended_ = true;
  if (thread_.joinable()) thread_.join();
  if (listener_ >= 0) close(listener_);
}

void CallWatch::serve() {
  while (!ended_) {
    pollfd state{listener_, POLLIN, 0};
    if (poll(&state, 1, 100) <= 0) continue;
    seccomp_notif asked{};
    if ((state.revents & POLLIN) == 0 || ioctl(listener_, SECCOMP_IOCTL_NOTIF_RECV, &asked) != 0) continue;
    if (looking_ && static_cast<pid_t>(asked.pid) == pid_) {
      ++looked_at_;
      const auto what = may_wait(watched().at(asked.data.nr), pid_, asked.data);
      const std::scoped_lock lock(mutex_);
      if (what && std::find(waits_.begin(), waits_.end(), *what) == waits_.end()) waits_.push_back(*what);
    }
    seccomp_notif_resp answer{};
    answer.id = asked.id;
    answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
    (void)ioctl(listener_, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
}

std::vector<std::string> CallWatch::waits() {
  const std::scoped_lock lock(mutex_);
  return waits_;
}

}  // namespace odomcalib::test_support
