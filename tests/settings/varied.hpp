// Included first by every source of a tree that tests/settings/vary.py has made; no part of any program
// otherwise.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <type_traits>

namespace odomcalib_varied {

inline constexpr std::size_t kMost = 2048;
/// s of a processor, after which a calibration with another number is given up.
inline constexpr rlim_t kPatience_s = 120;

/// Where a program first reads a setting, it goes on in three processes: with the value as it is, with its
/// half and with its double. What was done before is done once for all of them. Each of the others writes its
/// standard output to a file "stdout".
///
/// ODOMCALIB_VARIED names the folder in which the others work, each in its own: 12_0.5 halves number 12.
/// A file "done" in it has the numbers that are to be left alone, one a line. Afterwards "read" has the
/// numbers that the program has read, and "status" a line for each other process: number, factor, what wait()
/// said.
class Varied {
 public:
  Varied() {
    if (folder_.empty()) return;
    std::FILE* done = std::fopen((folder_ + "/done").c_str(), "r");
    for (std::size_t number = 0; done && std::fscanf(done, "%zu", &number) == 1;)
      if (number < kMost) done_.at(number) = true;
    if (done) std::fclose(done);
  }
  Varied(const Varied&) = delete;
  Varied& operator=(const Varied&) = delete;
  ~Varied() {
    std::FILE* read =
        folder_.empty() || number_ >= 0 ? nullptr : std::fopen((folder_ + "/read").c_str(), "w");
    if (!read) return;
    for (std::size_t k = 0; k < kMost; ++k)
      if (is_read_.at(k)) std::fprintf(read, "%zu\n", k);
    std::fclose(read);
  }

  double factor_on(int number) {
    bool& is_read = is_read_.at(static_cast<std::size_t>(number));
    if (!is_read && !folder_.empty() && number_ < 0 && !done_.at(static_cast<std::size_t>(number)))
      for (const char* factor : {"0.5", "2"})
        if (is_other_process(number, factor)) break;
    is_read = true;
    return number == number_ ? factor_ : 1.0;
  }

 private:
  /// Whether this is the process that goes on with the number times the factor; the one before waits for it.
  bool is_other_process(int number, const char* factor) {
    const pid_t child = fork();
    if (child != 0) {
      int status = -1;
      if (child > 0) waitpid(child, &status, 0);
      if (std::FILE* file = std::fopen((folder_ + "/status").c_str(), "a")) {
        std::fprintf(file, "%d %s %d\n", number, factor, status);
        std::fclose(file);
      }
      return false;
    }
    number_ = number;
    factor_ = std::atof(factor);
    const std::string own = folder_ + "/" + std::to_string(number) + "_" + factor;
    mkdir(own.c_str(), 0755);
    if (chdir(own.c_str()) != 0) _exit(126);
    if (const int out = open("stdout", O_CREAT | O_TRUNC | O_WRONLY, 0644); out >= 0)
      dup2(out, STDOUT_FILENO);
    const rlimit patience{kPatience_s, kPatience_s};
    setrlimit(RLIMIT_CPU, &patience);
    return true;
  }

  std::string folder_ = std::getenv("ODOMCALIB_VARIED") ? std::getenv("ODOMCALIB_VARIED") : "";
  int number_ = -1;
  double factor_ = 1.0;
  std::array<bool, kMost> is_read_{}, done_{};
};

inline Varied& varied() {
  static Varied only;
  return only;
}

}  // namespace odomcalib_varied

/// A number times its factor.
template <typename Value>
Value odomcalib_scaled(const Value& value, double factor) {
  if (factor == 1.0) return value;
  const double changed = static_cast<double>(value) * factor;
  if constexpr (std::is_floating_point_v<Value>)
    return static_cast<Value>(changed);
  else  // A count keeps at least one, and the half of one is one.
    return value > Value{0} ? std::max(Value{1}, static_cast<Value>(changed)) : static_cast<Value>(changed);
}
/// A list, whose numbers change together.
template <typename Value, std::size_t kSize>
std::array<Value, kSize> odomcalib_scaled(std::array<Value, kSize> values, double factor) {
  for (Value& value : values) value = odomcalib_scaled(value, factor);
  return values;
}

/// The value of a setting, or what the environment makes of it.
template <int kNumber, typename Value>
Value odomcalib_varied_now(const Value& value) {
  return odomcalib_scaled(value, odomcalib_varied::varied().factor_on(kNumber));
}

/// The same where the compiler may have to know the value: then it stays as it is.
template <int kNumber, typename Value>
constexpr Value odomcalib_varied_value(const Value& value) {
  if constexpr (std::is_same_v<Value, bool>) return value;
  if (std::is_constant_evaluated()) return value;
  return odomcalib_varied_now<kNumber>(value);
}
