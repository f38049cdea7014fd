// Middleware whose messages a recording holds.
#pragma once

#include <cstdint>

namespace odomcalib {

/// By the encoding of the messages that were taken; recordings of other forms hold none.
enum class Middleware : std::uint8_t { none, ros1, ros2 };

/// As files have it: ros1, ros2; empty for none.
constexpr const char* name_of(Middleware middleware) {
  if (middleware == Middleware::none) return "";
  return middleware == Middleware::ros1 ? "ros1" : "ros2";
}

}  // namespace odomcalib
