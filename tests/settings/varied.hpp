// Included first by every source of a tree that tests/settings/vary.py has made; no part of any program
// otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace odomcalib_varied {

inline constexpr std::size_t kMost = 2048;

/// The number of a setting and a factor on it: ODOMCALIB_VARIED=12:0.5 halves number 12.
/// ODOMCALIB_VARIED_READ names a file that gets the numbers that the program read while it ran, one a line.
struct Choice {
  int number = -1;
  double factor = 1.0;
  const char* read = std::getenv("ODOMCALIB_VARIED_READ");
  std::array<bool, kMost> is_read{};

  Choice() {
    if (const char* text = std::getenv("ODOMCALIB_VARIED")) std::sscanf(text, "%d:%lf", &number, &factor);
  }
  Choice(const Choice&) = delete;
  Choice& operator=(const Choice&) = delete;
  ~Choice() {
    std::FILE* file = read ? std::fopen(read, "w") : nullptr;
    if (!file) return;
    for (std::size_t k = 0; k < kMost; ++k)
      if (is_read.at(k)) std::fprintf(file, "%zu\n", k);
    std::fclose(file);
  }
};

inline Choice& choice() {
  static Choice only;
  return only;
}

}  // namespace odomcalib_varied

/// The value of a setting, or what the environment makes of it. What the compiler must know stays as it is.
template <int kNumber, typename Value>
constexpr Value odomcalib_varied_value(const Value& value) {
  if constexpr (!std::is_arithmetic_v<Value> || std::is_same_v<Value, bool>) {
    return value;
  } else {
    if (std::is_constant_evaluated()) return value;
    odomcalib_varied::Choice& choice = odomcalib_varied::choice();
    choice.is_read.at(kNumber) = true;
    if (choice.number != kNumber) return value;
    const double changed = static_cast<double>(value) * choice.factor;
    if constexpr (std::is_floating_point_v<Value>)
      return static_cast<Value>(changed);
    else  // A count keeps at least one, and the half of one is one.
      return value > Value{0} ? std::max(Value{1}, static_cast<Value>(changed)) : static_cast<Value>(changed);
  }
}
