// The files that ROS records into, written as their format pages say (wiki.ros.org/Bags/Format/2.0,
// mcap.dev/spec, rosbag2_storage_sqlite3). Shares no code with the readers in proto/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/sim/ros/ros_log.hpp"

namespace odomcalib::sim {

enum class RosPacking { none, bz2, lz4, zstd };

/// One stream or frame.
std::string packed(RosPacking packing, const std::string& bytes);

struct BagOptions {
  RosPacking packing = RosPacking::none;   ///< of chunks: none, bz2, lz4
  std::size_t chunk_bytes = 768UL * 1024;  ///< as rosbag record
  bool closed = true;                      ///< with index; a recorder that was killed leaves a file without
};
std::string write_bag(const RosLog& log, const BagOptions& options = {});

struct McapOptions {
  RosPacking packing = RosPacking::none;    ///< of chunks: none, lz4, zstd
  std::size_t chunk_bytes = 1024UL * 1024;  ///< 0: no chunks
  bool closed = true;                       ///< with end and footer
};
std::string write_mcap(const RosLog& log, const McapOptions& options = {});

struct Rosbag2Options {
  bool packed_messages = false;  ///< zstd, each alone
  bool write_ahead_log = false;  ///< the file says that its writer kept one
};
/// Writes a new file. Throws std::runtime_error when SQLite fails.
void write_rosbag2(const RosLog& log, const std::filesystem::path& path, const Rosbag2Options& options = {});

}  // namespace odomcalib::sim
