#include "drivers/lidar/lidar.hpp"

#include <functional>

#include "drivers/lidar/rplidar/packet.hpp"
#include "drivers/lidar/rplidar/startup.hpp"
#include "drivers/lidar/scip/parameters.hpp"
#include "drivers/lidar/ydlidar/packet.hpp"

namespace odomcalib::drivers {

using Made = std::unique_ptr<Lidar>;

// Each in the folder of its name.
/// @param points_per_s 4500, or 21600 (STL-27L)
Made make_ld06(const LidarOptions& options, double points_per_s);
/// @param guessed type of capsules of 84 bytes in a recording that begins without a descriptor; none: their
/// distances tell
Made make_rplidar(const LidarOptions& options, rplidar::Startup::Mode mode,
                  std::optional<rplidar::PacketType> guessed);
Made make_xv11(const LidarOptions& options);
/// @param model of ydlidar::models(), which live for ever
Made make_ydlidar(const LidarOptions& options, const ydlidar::Model& model);
/// @param known geometry to begin with; what the sensor tells goes before
Made make_scip(const LidarOptions& options, bool intensities, std::optional<scip::Parameters> known);
Made make_cola(const LidarOptions& options);

namespace {

/// A type and how its driver is made: a new lidar is one more line of the table.
struct Entry {
  LidarType type;
  std::function<Made(const LidarOptions& options)> make;
};

template <typename Make, typename... Arguments>
Entry entry(LidarType type, Make make, Arguments... arguments) {
  return {std::move(type), [=](const LidarOptions& options) { return make(options, arguments...); }};
}

/// "ydlidar" and "ydlidar:MODEL" for every model.
void add_ydlidars(std::vector<Entry>& out) {
  const auto add = [&](const std::string& name, const ydlidar::Model& model, const std::string& text) {
    out.push_back(
        entry({name, model.baud, model.answers ? 8000U : 0U, true, text}, make_ydlidar, std::cref(model)));
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
    out.push_back(entry(type(name, ""), make_scip, false, std::nullopt));
    out.push_back(entry(type(name + ":intensity", ", with intensities"), make_scip, true, std::nullopt));
  }
  for (const std::string model : {"utm30lx", "urg04lx"})
    out.push_back(entry(type("hokuyo:" + model, ", recordings without parameters"), make_scip, false,
                        scip::known_parameters(model)));
}

std::vector<Entry> make_entries() {
  using Mode = rplidar::Startup::Mode;
  const std::string rplidar = "SLAMTEC RPLIDAR A, S and C series";
  std::vector<Entry> out = {
      entry({"ld06", 230'400, 0, true, "LDROBOT LD06, STL-06P"}, make_ld06, 4500.0),
      entry({"ld19", 230'400, 0, true, "LDROBOT LD19, STL-19P"}, make_ld06, 4500.0),
      entry({"stl27l", 921'600, 0, true, "LDROBOT STL-27L"}, make_ld06, 21'600.0),
      entry({"rplidar", 115'200, 20'108, false, rplidar}, make_rplidar, Mode::automatic, std::nullopt),
      entry({"rplidar:standard", 115'200, 20'108, false, rplidar + ", uncompressed"}, make_rplidar,
            Mode::standard, std::nullopt),
      entry({"rplidar:express", 115'200, 20'108, false, rplidar + ", oldest compressed mode"}, make_rplidar,
            Mode::express, rplidar::PacketType::express),
      entry({"rplidar:dense", 115'200, 20'108, false, "recordings of dense capsules that begin late"},
            make_rplidar, Mode::automatic, rplidar::PacketType::dense),
      entry({"xv11", 115'200, 0, true, "Neato XV-11"}, make_xv11),
  };
  add_ydlidars(out);
  add_hokuyos(out);
  for (const std::string name : {"sick", "cola"})
    out.push_back(
        entry({name, 0, 2112, true, "SICK LMS1xx, LMS5xx, TiM5xx, TiM7xx, MRS1000 (CoLa)"}, make_cola));
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
