#include "daemon/service/lidar_link.hpp"

#include <charconv>

namespace odomcalib {
namespace {

constexpr double kRetry = 0.5;  // s

unsigned baud_of(const std::string& text) {
  unsigned baud = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), baud);
  return parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size() ? baud : 0;
}

}  // namespace

LidarLink::LidarLink(std::string device, std::string path, unsigned baud,
                     std::unique_ptr<drivers::Lidar> lidar)
    : device_(std::move(device)), path_(std::move(path)), baud_(baud), lidar_(std::move(lidar)) {}

Result<LidarLink> LidarLink::create(const std::string& device, const std::string& type) {
  const auto parsed = drivers::parse_device(device);
  if (!parsed) return parsed.error();
  const unsigned baud = baud_of(parsed.value().option("baud", "230400"));
  if (parsed.value().scheme != "serial" || baud == 0)
    return Error{ErrorCode::usage, "a lidar needs a device like \"serial:/dev/ttyUSB0?baud=230400\"", device,
                 "correct lidar.device in the configuration"};
  auto lidar = drivers::make_lidar(type, baud);
  if (!lidar) return lidar.error();
  return LidarLink(device, parsed.value().path, baud, std::move(lidar).value());
}

void LidarLink::lose(const Error& error, double now) {
  problem_ = error;
  port_.reset();
  lidar_->reset();
  next_try_ = now + kRetry;
}

void LidarLink::open_when_due(double now) {
  if (port_ || now < next_try_) return;
  auto opened = drivers::open_serial(path_, baud_);
  if (!opened) return lose(opened.error(), now);
  port_ = std::move(opened).value();
  problem_.reset();
  ++opened_;
}

void LidarLink::step(double now) {
  open_when_due(now);
  if (!port_) return;
  const auto bytes = port_->read();
  if (!bytes) return lose(bytes.error(), now);
  lidar_->on_bytes(bytes.value(), now);
  const auto output = lidar_->take_output();
  if (output.empty()) return;
  if (const auto written = port_->write(output); !written) lose(written.error(), now);
}

drivers::Counters LidarLink::counters() const {
  drivers::Counters all = lidar_->counters();
  all["reconnects"] = opened_ > 0 ? opened_ - 1 : 0;
  return all;
}

}  // namespace odomcalib
