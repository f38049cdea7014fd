// Calibration files: what is accepted must survive writing and reading.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "proto/calibration/calibration.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto first = odomcalib::calibration_from_json({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!first.ok()) return 0;
  const auto text = odomcalib::to_json(first.value());
  const auto second = odomcalib::calibration_from_json(text, "fuzz");
  if (!second.ok() || odomcalib::to_json(second.value()) != text) std::abort();
  return 0;
}
