// The tables of a CANopen profile.
#include <cmath>
#include <numbers>

#include "drivers/base/profile/profile.hpp"
#include "drivers/base/profile/profile_reader.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::drivers {
namespace {

constexpr std::int64_t kU32Max = 0xFFFFFFFF;

ProfileWrite read_write(ProfileTable& table) {
  ProfileWrite write;
  write.object = table.object("object", std::nullopt);
  write.type = table.type("type", std::nullopt);
  write.value = table.integer("value", std::nullopt, INT32_MIN, kU32Max);
  if (!canopen::fits(write.value, write.type))
    table.complain("value", "does not fit the type", "what the type holds");
  table.finish();
  return write;
}

std::vector<ProfileWrite> read_writes(ProfileTable& table, std::string_view key) {
  std::vector<ProfileWrite> out;
  for (ProfileTable& element : table.tables(key)) out.push_back(read_write(element));
  return out;
}

ProfileWatchdog read_watchdog(ProfileTable table) {
  ProfileWatchdog watchdog;
  const std::string kind = table.text("kind", "none");
  watchdog.time_ms = table.number("time_ms", 200.0, 20.0, 1000.0);
  watchdog.also = read_writes(table, "also");
  if (kind == "1016") {
    watchdog.kind = ProfileWatchdog::Kind::heartbeat_consumer;
    watchdog.object = table.object("object", "1016:01");
    watchdog.type = {4, false};
  } else if (kind == "object") {
    watchdog.kind = ProfileWatchdog::Kind::object;
    watchdog.object = table.object("object", std::nullopt);
    watchdog.type = table.type("type", "u16");
    watchdog.unit_ms = table.number("unit_ms", 1.0, 1e-3, 1000.0);
  } else if (kind != "none") {
    table.complain("kind", "\"" + kind + "\"", R"("1016", "object" or "none")");
  }
  table.finish();
  return watchdog;
}

void read_identity(ProfileTable table, Profile& profile) {
  profile.vendor = static_cast<std::uint32_t>(table.integer("vendor", 0, 0, kU32Max));
  profile.product = static_cast<std::uint32_t>(table.integer("product", 0, 0, kU32Max));
  table.finish();
}

void read_heartbeat(ProfileTable table, Profile& profile) {
  profile.heartbeat_ms = static_cast<std::uint16_t>(table.integer("period_ms", 30, 10, 1000));
  profile.heartbeat_unit_ms = table.number("unit_ms", 1.0, 1e-3, 1000.0);
  profile.host_node = static_cast<std::uint8_t>(table.integer("host_node", 0x7F, 1, 127));
  table.finish();
}

void read_objects(ProfileTable table, Profile& profile) {
  const bool one = profile.axes == 1;
  profile.position_left = table.object(one ? "position" : "position_left", std::nullopt);
  profile.speed_left = table.object(one ? "speed" : "speed_left", std::nullopt);
  if (!one) {
    profile.position_right = table.object("position_right", std::nullopt);
    profile.speed_right = table.object("speed_right", std::nullopt);
  }
  profile.status = table.object("status", "6041:00");
  profile.control = table.object("control", "6040:00");
  if (table.has("fault")) profile.fault = table.object("fault", std::nullopt);
  table.finish();
}

void read_mode(ProfileTable table, Profile& profile) {
  if (!table.exists()) return;
  ProfileWrite mode;
  mode.object = table.object("object", "6060:00");
  mode.type = {1, true};
  mode.value = table.integer("value", 3, -128, 127);
  profile.mode_display = table.object("display", "6061:00");
  profile.mode = mode;
  table.finish();
}

void read_sync(ProfileTable table, Profile& profile) {
  if (!table.exists()) return;
  profile.sync_period_s = 1e-3 * table.number("period_ms", std::nullopt, 5.0, 100.0);
  table.finish();
}

canopen::Pdo read_pdo(ProfileTable& table, bool transmit, const Profile& profile) {
  canopen::Pdo pdo;
  pdo.transmit = transmit;
  pdo.number = static_cast<std::uint16_t>(table.integer("number", std::nullopt, 1, 512));
  const std::int64_t first = transmit ? 0x180 : 0x200;
  const std::int64_t usual = first + std::int64_t{0x100} * ((pdo.number - 1) % 4) + profile.node;
  pdo.cob_id = static_cast<std::uint32_t>(usual);
  if (profile.axes == 2)  // two drives with one identifier would collide
    pdo.cob_id = static_cast<std::uint32_t>(table.integer("cob_id", usual, 0x181, 0x57F));
  pdo.type = static_cast<std::uint8_t>(table.integer("type", 255, 0, 255));
  if (table.has("inhibit")) pdo.inhibit = static_cast<std::uint16_t>(table.integer("inhibit", 0, 0, 65535));
  if (table.has("event_timer"))
    pdo.event_timer = static_cast<std::uint16_t>(table.integer("event_timer", 0, 0, 65535));
  pdo.entries = table.entries("map");
  table.finish();
  return pdo;
}

std::int64_t most_of(canopen::NumberType type) {
  if (type.bytes >= 8) return INT64_MAX;
  const unsigned bits = 8u * type.bytes - (type.is_signed ? 1u : 0u);
  return (std::int64_t{1} << bits) - 1;
}

std::string read_quantity(ProfileTable& table, const Profile& profile) {
  std::string quantity = table.text("quantity", std::nullopt);
  if (profile.axes == 1) {
    if (quantity == "wheel_diameter") return profile.side + "_wheel_diameter";
    table.complain("quantity", "\"" + quantity + "\"", "wheel_diameter");
  } else if (!is_drive_length(quantity)) {
    table.complain("quantity", "\"" + quantity + "\"",
                   "left_wheel_diameter, right_wheel_diameter, track_width");
  }
  return quantity;
}

ProfileParameter read_parameter(ProfileTable& table, const Profile& profile) {
  ProfileParameter parameter;
  parameter.quantity = read_quantity(table, profile);
  parameter.object = table.object("object", std::nullopt);
  parameter.type = table.type("type", "u32");
  parameter.scale = table.number("scale", std::nullopt, 1e-12, 1e6);
  const std::string formula = table.text("formula", "length");
  if (formula != "length" && formula != "feed")
    table.complain("formula", "\"" + formula + "\"", "length, feed");
  parameter.feed = formula == "feed";
  parameter.turns = table.number("turns", 1.0, 1.0, 1e6);
  const std::int64_t most = most_of(parameter.type);
  parameter.min = table.integer("min", 1, 0, most);
  parameter.max = table.integer("max", most, parameter.min, most);
  table.finish();
  return parameter;
}

void read_store(ProfileTable table, Profile& profile) {
  if (!table.exists()) return;
  ProfileStore store;
  store.wait_s = table.number("wait_s", 5.0, 0.1, 60.0);
  store.object = table.object("object", "1010:01");
  store.type = table.type("type", "u32");
  store.value = table.integer("value", 0x65766173, 0, kU32Max);
  const std::string verify = table.text("verify", "readback");
  if (verify != "readback" && verify != "reset")
    table.complain("verify", "\"" + verify + "\"", R"("readback" or "reset")");
  store.verify_after_reset = verify == "reset";
  profile.store = store;
  table.finish();
}

bool mapped(const Profile& profile, const canopen::ObjectAddress& object, bool transmit) {
  for (const canopen::Pdo& pdo : profile.pdos)
    for (const canopen::PdoEntry& entry : pdo.entries)
      if (pdo.transmit == transmit && entry.object == object) return true;
  return false;
}

/// Objects that the controller cannot work without must be somewhere in the process data.
void check_mapping(ProfileTable& table, const Profile& profile) {
  const bool two = profile.axes == 2;
  for (const auto& object :
       {profile.position_left, two ? profile.position_right : profile.position_left, profile.status})
    if (!mapped(profile, object, true))
      table.complain("tpdo", canopen::to_text(object) + " is mapped nowhere",
                     "positions and status in some tpdo");
  for (const auto& object :
       {profile.control, profile.speed_left, two ? profile.speed_right : profile.speed_left})
    if (!mapped(profile, object, false))
      table.complain("rpdo", canopen::to_text(object) + " is mapped nowhere",
                     "control and speeds in some rpdo");
}

}  // namespace

void read_canopen_tables(ProfileTable& table, Profile& profile) {
  read_identity(table.table("identity"), profile);
  read_heartbeat(table.table("heartbeat"), profile);
  profile.watchdog = read_watchdog(table.table("watchdog"));
  profile.init = read_writes(table, "init");
  read_objects(table.table("objects"), profile);
  read_mode(table.table("mode"), profile);
  read_sync(table.table("sync"), profile);
  for (ProfileTable& pdo : table.tables("tpdo")) profile.pdos.push_back(read_pdo(pdo, true, profile));
  for (ProfileTable& pdo : table.tables("rpdo")) profile.pdos.push_back(read_pdo(pdo, false, profile));
  for (ProfileTable& parameter : table.tables("parameter"))
    profile.parameters.push_back(read_parameter(parameter, profile));
  read_store(table.table("store"), profile);
  check_mapping(table, profile);
}

double ProfileParameter::to_si(std::int64_t raw) const {
  const double length = static_cast<double>(raw) * scale;
  return feed ? length / (std::numbers::pi * turns) : length;
}

std::optional<std::int64_t> ProfileParameter::to_raw(double si) const {
  const double length = feed ? si * std::numbers::pi * turns : si;
  const double raw = std::round(length / scale);
  if (!std::isfinite(raw) || raw < static_cast<double>(min) || raw > static_cast<double>(max))
    return std::nullopt;
  return static_cast<std::int64_t>(raw);
}

}  // namespace odomcalib::drivers
