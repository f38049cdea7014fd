// The measurement telegram LMDscandata.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/cola/arguments.hpp"

namespace odomcalib::drivers::cola {

/// One output channel, such as DIST1 (distances of the first echo, mm) or RSSI1.
struct Channel {
  std::string name;
  float factor = 1.0F, offset = 0.0F;  ///< value = raw * factor + offset
  std::int32_t start = 0;              ///< 1/10000 degree
  std::uint32_t step = 0;              ///< 1/10000 degree, rounded
  std::vector<std::uint16_t> values;   ///< raw
};

struct ScanData {
  std::uint32_t serial_number = 0;
  unsigned status = 0;  ///< low byte: 1 error, 2 pollution warning, 4 pollution error
  unsigned telegram_counter = 0, scan_counter = 0;  ///< 16 bits each
  std::uint32_t started_us = 0, sent_us = 0;        ///< device clock
  int layer = 0;                                    ///< of a sensor with several; 0: the horizontal one
  std::uint32_t turns_chz = 0;                      ///< 1/100 Hz
  std::uint32_t measurements_hundred_hz = 0;        ///< 100 Hz
  std::vector<Channel> channels;

  /// nullptr when there is none of that name.
  [[nodiscard]] const Channel* find(const std::string& name) const;
};

/// Absent when the data are cut off or contradict themselves. What follows the channels is not read.
std::optional<ScanData> read_scan_data(Dialect dialect, Bytes bytes);

/// Degrees between beams. The field is rounded to whole 1/10000 degrees, but thirds and sixths are exact in
/// the device.
double true_step(std::uint32_t step);

}  // namespace odomcalib::drivers::cola
