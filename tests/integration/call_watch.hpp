// Shows which calls of a program's first thread may wait, as the kernel sees them (seccomp): whatever library
// makes them, and whether they happen to wait this time or not.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace odomcalib::test_support {

class CallWatch {
 public:
  /// Starts the program. @param output file that takes standard output and standard error
  CallWatch(const std::vector<std::string>& arguments, const std::filesystem::path& output);
  ~CallWatch();  ///< SIGKILL when it still runs
  CallWatch(const CallWatch&) = delete;
  CallWatch& operator=(const CallWatch&) = delete;

  /// Why nothing can be watched here; empty: it is.
  [[nodiscard]] const std::string& unable() const { return unable_; }
  /// From now on calls are looked at.
  void begin() { looking_ = true; }
  void end() { looking_ = false; }
  /// Calls that may wait, each once, with what they were for.
  [[nodiscard]] std::vector<std::string> waits();
  /// Calls that were looked at.
  [[nodiscard]] std::size_t looked_at() const { return looked_at_; }

 private:
  void serve();

  pid_t pid_ = -1;
  int listener_ = -1;
  std::string unable_;
  std::atomic<bool> looking_ = false, ended_ = false;
  std::atomic<std::size_t> looked_at_ = 0;
  std::mutex mutex_;
  std::vector<std::string> waits_;
  std::thread thread_;
};

}  // namespace odomcalib::test_support
