// The value that a test goes on with, or the end of the test.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "proto/result.hpp"

namespace odomcalib {

/// An error ends the test and says where. Clang 14 has no std::source_location.
template <typename T>
T value_of(Result<T> result, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (!result.ok())
    throw std::runtime_error(std::string(file) + ":" + std::to_string(line) + ": " + result.error().text());
  return std::move(result).value();
}

}  // namespace odomcalib
