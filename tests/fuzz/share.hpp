// Choice of the inputs that a harness looks at thoroughly. Everything that follows from the bytes alone is
// checked for every input; checks that take longer than parsing (counting after every read, another object
// that reads the same in other pieces) for one in sixteen while fuzzing, chosen by a hash of the input so
// that a finding repeats, and for each one in a replay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace odomcalib::fuzz {

#ifndef ODOMCALIB_FUZZ_SHARE
#define ODOMCALIB_FUZZ_SHARE 16  // replays define 1
#endif

inline void require(bool condition) {
  if (!condition) std::abort();
}

/// FNV-1a, 32 bits: any function would do that spreads and is the same everywhere.
inline std::uint32_t hash_of(const std::uint8_t* data, std::size_t size) {
  std::uint32_t hash = 2'166'136'261U;
  for (std::size_t i = 0; i < size; ++i) hash = static_cast<std::uint32_t>((hash ^ data[i]) * 16'777'619ULL);
  return hash;
}

inline bool thorough(const std::uint8_t* data, std::size_t size) {
  return hash_of(data, size) % ODOMCALIB_FUZZ_SHARE == 0;
}

}  // namespace odomcalib::fuzz
