#include "drivers/lidar/lidar.hpp"

#include <functional>

#include "drivers/lidar/cola/cola.hpp"
#include "drivers/lidar/ld06/ld06.hpp"
#include "drivers/lidar/rplidar/rplidar.hpp"
#include "drivers/lidar/scip/scip.hpp"
#include "drivers/lidar/xv11/xv11.hpp"
#include "drivers/lidar/ydlidar/ydlidar.hpp"

namespace odomcalib::drivers {
namespace {

using Made = std::unique_ptr<Lidar>;

/// A type and how its driver is made: a new lidar is one more line of the table.
struct Entry {
  LidarType type;
  std::function<Made(const LidarOptions& options)> make;
};

template <typename Driver, typename... Arguments>
Entry entry(LidarType type, Arguments... arguments) {
  return {std::move(type), [=](const LidarOptions& options) -> Made {
            return std::make_unique<Driver>(options, arguments...);
          }};
}

/// "ydlidar" and "ydlidar:MODEL" for every model.
void add_ydlidars(std::vector<Entry>& out) {
  const auto add = [&](const std::string& name, const ydlidar::Model& model, const std::string& text) {
    out.push_back(
        entry<Ydlidar>({name, model.baud, model.answers ? 8000U : 0U, true, text}, std::cref(model)));
  };
  add("ydlidar", *ydlidar::find_model("x4"), "YDLIDAR X4 and recordings of two-byte samples");
  for (const ydlidar::Model& model : ydlidar::models())
    add(std::string("ydlidar:") + model.name, model, std::string("YDLIDAR ") + model.name);
}

/// The baud rate is that of RS-232 types; USB types take any.
void add_hokuyos(std::vector<Entry>& out) {
  const auto type = [](const std::string& name, const std::string& text) {
    return LidarType{name, 19'200, 10'940, true, "Hokuyo URG, UTM, UST (SCIP 2.0)" + text};
  };
  for (const std::string name : {"hokuyo", "scip"}) {
    out.push_back(entry<Scip>(type(name, "")));
    out.push_back(entry<Scip>(type(name + ":intensity", ", with intensities"), true));
  }
  for (const std::string model : {"utm30lx", "urg04lx"})
    out.push_back(entry<Scip>(type("hokuyo:" + model, ", recordings without parameters"), false,
                              scip::known_parameters(model)));
}

std::vector<Entry> make_entries() {
  using Mode = Rplidar::Mode;
  const std::string rplidar = "SLAMTEC RPLIDAR A, S and C series";
  std::vector<Entry> out = {
      entry<Ld06>({"ld06", 230'400, 0, true, "LDROBOT LD06, STL-06P"}),
      entry<Ld06>({"ld19", 230'400, 0, true, "LDROBOT LD19, STL-19P"}),
      entry<Ld06>({"stl27l", 921'600, 0, true, "LDROBOT STL-27L"}, 21'600.0),
      entry<Rplidar>({"rplidar", 115'200, 20'108, false, rplidar}),
      entry<Rplidar>({"rplidar:standard", 115'200, 20'108, false, rplidar + ", uncompressed"},
                     Mode::standard),
      entry<Rplidar>({"rplidar:express", 115'200, 20'108, false, rplidar + ", oldest compressed mode"},
                     Mode::express, rplidar::PacketType::express),
      entry<Rplidar>(
          {"rplidar:dense", 115'200, 20'108, false, "recordings of dense capsules that begin late"},
          Mode::automatic, rplidar::PacketType::dense),
      entry<Xv11>({"xv11", 115'200, 0, true, "Neato XV-11"}),
  };
  add_ydlidars(out);
  add_hokuyos(out);
  for (const std::string name : {"sick", "cola"})
    out.push_back(entry<Cola>({name, 0, 2112, true, "SICK LMS1xx, LMS5xx, TiM5xx, TiM7xx, MRS1000 (CoLa)"}));
  return out;
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> kEntries = make_entries();
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
