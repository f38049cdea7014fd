#include "proto/recording/ros/containers.hpp"

#include "proto/recording/ros/unpack.hpp"

namespace odomcalib::ros {
namespace {

constexpr std::string_view kBag = "#ROSBAG V2.0\n";
constexpr std::string_view kOldBag = "#ROSBAG V1";
constexpr std::string_view kRosRecord = "#ROSRECORD V1";
constexpr std::string_view kMcap("\x89MCAP0\r\n", 8);
constexpr std::string_view kSqlite("SQLite format 3\0", 16);

std::optional<Error> read_plain(std::string_view bytes, const std::string& where, Collector& collector) {
  if (bytes.starts_with(kBag)) return read_bag(bytes, where, collector);
  if (bytes.starts_with(kSqlite)) return read_rosbag2(bytes, where, collector);
  if (bytes.starts_with(kMcap)) {
    read_mcap(bytes, collector);
    return std::nullopt;
  }
  if (bytes.starts_with(kOldBag) || bytes.starts_with(kRosRecord))
    return Error{ErrorCode::format, "is a ROS bag older than 2.0", where,
                 "convert it where ROS 1 is installed: rosbag fix OLD.bag NEW.bag"};
  return Error{ErrorCode::format, "is packed with zstd and no ROS recording inside", where,
               "unpack it and look: zstd -d FILE"};
}

}  // namespace

bool looks_like_container(std::string_view bytes) {
  return bytes.starts_with(kBag) || bytes.starts_with(kOldBag) || bytes.starts_with(kRosRecord) ||
         bytes.starts_with(kMcap) || bytes.starts_with(kSqlite) || is_zstd(bytes);
}

namespace {

std::optional<Error> read_packed(std::string_view bytes, const std::string& where, Collector& collector) {
  if (!is_zstd(bytes)) return read_plain(bytes, where, collector);
  // rosbag2 with compression_mode "file"
  const Unpacked unpacked = collector.unpacker().file(Packing::zstd, bytes);
  if (unpacked.over_limit) return std::nullopt;  // refused as a whole
  if (!unpacked.whole && unpacked.bytes.empty())
    return Error{ErrorCode::format,
                 "is packed with zstd, and nothing of it can be unpacked: " + unpacked.problem, where,
                 "copy it from the robot again"};
  if (!unpacked.whole) collector.discard("file", unpacked.problem);
  return read_plain(unpacked.bytes, where, collector);
}

}  // namespace

std::optional<Error> read_container(std::string_view bytes, const std::string& where, Collector& collector) {
  collector.unpacker().begin_file(bytes.size());
  auto error = read_packed(bytes, where, collector);
  if (auto refused = collector.unpacker().refusal(where)) return refused;
  return error;
}

}  // namespace odomcalib::ros
