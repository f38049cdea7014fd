#include "drivers/lidar/lidar.hpp"

#include "drivers/lidar/ld06/ld06.hpp"
#include "drivers/lidar/rplidar/rplidar.hpp"

namespace odomcalib::drivers {
namespace {

using Made = std::unique_ptr<Lidar>;

/// A type and how its driver is made: a new lidar is one more line of the table.
struct Entry {
  LidarType type;
  Made (*make)(const LidarOptions& options);
};

const std::vector<Entry>& entries() {
  using Mode = Rplidar::Mode;
  using rplidar::PacketType;
  static const std::vector<Entry> kEntries = {
      {{"ld06", 230'400, 0, true, "LDROBOT LD06, STL-06P"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Ld06>(o); }},
      {{"ld19", 230'400, 0, true, "LDROBOT LD19, STL-19P"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Ld06>(o); }},
      {{"stl27l", 921'600, 0, true, "LDROBOT STL-27L"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Ld06>(o, 21'600.0); }},
      {{"rplidar", 115'200, 20'108, false, "SLAMTEC RPLIDAR A, S and C series"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Rplidar>(o); }},
      {{"rplidar:standard", 115'200, 20'108, false, "the same, uncompressed mode"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Rplidar>(o, Mode::standard); }},
      {{"rplidar:express", 115'200, 20'108, false, "the same, oldest compressed mode"},
       [](const LidarOptions& o) -> Made { return std::make_unique<Rplidar>(o, Mode::express); }},
      {{"rplidar:dense", 115'200, 20'108, false,
        "the same; recordings of dense capsules without a descriptor"},
       [](const LidarOptions& o) -> Made {
         return std::make_unique<Rplidar>(o, Mode::automatic, PacketType::dense);
       }},
  };
  return kEntries;
}

Error unknown(const std::string& name) {
  return {ErrorCode::usage, "unknown lidar type \"" + name + "\"", "lidar", "known: " + lidar_type_names()};
}

}  // namespace

const std::vector<LidarType>& lidar_types() {
  static const std::vector<LidarType> kTypes = [] {
    std::vector<LidarType> out;
    for (const Entry& entry : entries()) out.push_back(entry.type);
    return out;
  }();
  return kTypes;
}

std::string lidar_type_names() {
  std::string out;
  for (const LidarType& type : lidar_types()) out += (out.empty() ? "" : ", ") + type.name;
  return out;
}

Result<LidarType> find_lidar_type(const std::string& name) {
  for (const LidarType& type : lidar_types())
    if (type.name == name) return type;
  return unknown(name);
}

Result<Made> make_lidar(const std::string& type, const LidarOptions& options) {
  for (const Entry& entry : entries())
    if (entry.type.name == type) return entry.make(options);
  return unknown(type);
}

}  // namespace odomcalib::drivers
