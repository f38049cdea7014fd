// The files that ROS records into. Internal to proto/.
//
// All three are read from the first byte to the last, the indexes in them are not followed: a file that was
// never closed is read like any other, and no index can lead astray. What is damaged or cut off is counted in
// the collector, and what is whole before and after it is used.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "proto/recording/ros/collector.hpp"
#include "proto/result.hpp"

namespace odomcalib::ros {

/// Whether the bytes begin like one of the containers below, packed with zstd or not.
bool looks_like_container(std::string_view bytes);

/// Reads any of them. Error: format, where nothing of it can be read; it says what to do.
std::optional<Error> read_container(std::string_view bytes, const std::string& where, Collector& collector);

/// Bag format 2.0 (wiki.ros.org/Bags/Format/2.0), chunks plain, bz2 or lz4. Error: format (encrypted).
std::optional<Error> read_bag(std::string_view bytes, const std::string& where, Collector& collector);

/// MCAP (mcap.dev/spec), chunks plain, lz4 or zstd, with or without chunks, index and summary.
void read_mcap(std::string_view bytes, Collector& collector);

/// The sqlite3 storage of rosbag2, messages plain or zstd. Error: format (no such tables).
std::optional<Error> read_rosbag2(std::string_view bytes, const std::string& where, Collector& collector);

}  // namespace odomcalib::ros
