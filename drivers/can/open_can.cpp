
#include "drivers/can/settings.hpp"
#include "drivers/can/slcan.hpp"
#include "drivers/can/socketcan.hpp"
#include "drivers/serial/port.hpp"
#include "proto/number_text.hpp"

namespace odomcalib::drivers {
namespace {

using namespace can;

Result<unsigned> number(const DeviceString& device, const std::string& key, unsigned otherwise) {
  const std::string text = device.option(key, std::to_string(otherwise));
  if (const auto value = number_from<unsigned>(text)) return *value;
  return Error{ErrorCode::usage, "\"" + key + "=" + text + "\" is not a whole number", device.path, ""};
}

Result<std::unique_ptr<CanTransport>> open_slcan_device(const DeviceString& device) {
  const auto bitrate = number(device, "bitrate", SlcanOptions().bitrate);
  if (!bitrate) return bitrate.error();
  const auto baud = number(device, "baud", kAnyBaud);
  if (!baud) return baud.error();
  SlcanOptions options;
  if (!device.option("baud", "").empty()) options.baud = baud.value();
  const auto stamps = number(device, "timestamps", 0);
  if (!stamps) return stamps.error();
  auto port = open_serial(device.path, baud.value());
  if (!port) return port.error();
  options.bitrate = bitrate.value();
  options.timestamps = stamps.value() != 0;
  return open_slcan(std::move(port).value(), device.path, options);
}

}  // namespace

Result<std::unique_ptr<CanTransport>> open_can(const std::string& device) {
  const auto parsed = parse_device(device);
  if (!parsed) return parsed.error();
  if (parsed.value().scheme == "socketcan") return open_socketcan(parsed.value().path);
  if (parsed.value().scheme == "slcan") return open_slcan_device(parsed.value());
  return Error{ErrorCode::usage, "\"" + parsed.value().scheme + "\" is no way to a CAN bus", device,
               "use socketcan:can0 or slcan:/dev/ttyACM0?bitrate=500000"};
}

}  // namespace odomcalib::drivers
