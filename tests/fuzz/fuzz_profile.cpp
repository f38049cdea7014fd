// Text as a controller profile: whatever it says, the answer is a profile or an error with a place.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "drivers/base/profile/profile.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto profile = odomcalib::drivers::parse_profile({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!profile && profile.error().where.empty()) std::abort();
  if (profile && !(profile.value().ticks_per_rev >= 1.0)) std::abort();
  return 0;
}
