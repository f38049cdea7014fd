#include "daemon/service/lidar_link.hpp"

#include <algorithm>

#include "daemon/service/settings.hpp"
#include "drivers/tcp/tcp_stream.hpp"
#include "proto/number_text.hpp"

namespace odomcalib {
namespace {

/// "host" to "host:port"; an IPv6 address is in brackets.
std::string with_port(const std::string& path, unsigned port) {
  const std::size_t bracket = path.find(']');
  const bool has_port = path.find(':', bracket == std::string::npos ? 0 : bracket) != std::string::npos;
  return has_port ? path : path + ":" + std::to_string(port);
}

}  // namespace

LidarLink::LidarLink(std::string device, Address address, std::unique_ptr<drivers::Lidar> lidar)
    : device_(std::move(device)), address_(std::move(address)), lidar_(std::move(lidar)) {}

LidarLink::~LidarLink() {
  if (stream_ && connected_) (void)stream_->write(lidar_->stop_bytes());
}

Result<LidarLink::Address> LidarLink::address_of(const std::string& device, const drivers::LidarType& type) {
  const auto parsed = drivers::parse_device(device);
  if (!parsed) return parsed.error();
  const drivers::DeviceString& parts = parsed.value();
  if (parts.scheme == "tcp" && type.port != 0) return Address{true, with_port(parts.path, type.port), 0, {}};
  constexpr const char* kCorrect = "correct lidar.device in the configuration";
  if (parts.scheme == "serial" && type.baud != 0) {
    const unsigned baud = number_from<unsigned>(parts.option("baud", std::to_string(type.baud))).value_or(0);
    if (baud == 0)
      return Error{ErrorCode::usage, "\"" + parts.option("baud", "") + "\" is no baud rate", device,
                   kCorrect};
    const std::string dtr = parts.option("dtr", type.dtr ? "1" : "0");
    if (dtr != "0" && dtr != "1")
      return Error{ErrorCode::usage, "\"dtr=" + dtr + "\" is neither 0 nor 1", device, kCorrect};
    return Address{false, parts.path, baud, {dtr == "1", true}};
  }
  const std::string serial = "\"serial:/dev/ttyUSB0?baud=" + std::to_string(type.baud) + "\"";
  const std::string network = "\"tcp:192.168.0.10:" + std::to_string(type.port) + "\"";
  return Error{ErrorCode::usage,
               "a lidar of type " + type.name + " needs a device like " +
                   (type.baud == 0   ? network
                    : type.port == 0 ? serial
                                     : serial + " or " + network),
               device, kCorrect};
}

Result<LidarLink> LidarLink::create(const std::string& device, const std::string& type) {
  const auto known = drivers::find_lidar_type(type);
  if (!known) return known.error();
  auto address = address_of(device, known.value());
  if (!address) return address.error();
  drivers::LidarOptions options;
  options.baud = address.value().baud;
  auto lidar = drivers::make_lidar(type, options);
  if (!lidar) return lidar.error();
  return LidarLink(device, std::move(address).value(), std::move(lidar).value());
}

void LidarLink::lose(const Error& error, double now) {
  problem_ = error;
  ++taken_;
  stream_.reset();
  connected_ = false;
  lidar_->reset();
  next_try_ = now + std::min(service::settings::kLidarFirstRetry_s *
                                 static_cast<double>(1U << std::min(failures_, 4U)),
                             service::settings::kLidarLastRetry_s);
  ++failures_;
}

std::string LidarLink::host_name() const {
  if (!address_.network || drivers::is_numeric(address_.path)) return "";
  return address_.path.substr(0, address_.path.rfind(':'));
}

/// A name is looked up anew for each connection: the lidar may have got another address since.
/// @return nullopt: no answer yet
std::optional<Result<std::string>> LidarLink::address_now() {
  if (!lookup_) {
    if (host_name().empty()) return address_.path;
    lookup_ = std::make_unique<drivers::HostLookup>(address_.path);
    if (!problem_)
      problem_ = {ErrorCode::device, "the name \"" + host_name() + "\" is being looked up", device_,
                  "wait, or write the address in numbers"};
  }
  auto answer = lookup_->answer();
  if (!answer) return std::nullopt;
  lookup_.reset();
  if (answer->ok()) found_address_ = answer->value();
  return answer;
}

void LidarLink::open_when_due(double now) {
  if (stream_ || now < next_try_) return;
  const auto address = address_now();
  if (!address) return;
  if (!*address) return lose(address->error(), now);
  auto opened = address_.network ? drivers::open_tcp(address->value())
                                 : drivers::open_serial(address_.path, address_.baud, address_.lines);
  if (!opened) return lose(opened.error(), now);
  stream_ = std::move(opened).value();
  opened_at_ = now;
}

bool LidarLink::finish_connecting(double now) {
  if (connected_) return true;
  const auto done = stream_->connected();
  if (!done) return lose(done.error(), now), false;
  if (!done.value() && now - opened_at_ > service::settings::kLidarConnect_s)
    return lose({ErrorCode::timeout, "the device does not accept a connection", device_,
                 "check power, cable and address: ping the device"},
                now),
           false;
  if (!done.value()) return false;
  connected_ = true;
  problem_.reset();
  ++taken_;
  ++opened_;
  const auto counters = lidar_->counters();
  watch_ = {now, counters.at("bytes_in"), counters.at("good")};
  return true;
}

Error LidarLink::nothing_valid(bool silent) const {
  if (silent)
    return {ErrorCode::timeout, "connected, but nothing arrives", device_,
            "check the lidar's power and wiring, and lidar.type"};
  return {ErrorCode::format, "bytes arrive, but none of them is a valid packet", device_,
          address_.network ? "check lidar.type" : "check the baud rate in lidar.device, and lidar.type"};
}

/// Names what is wrong when a while has brought no valid packet. A silent network connection may be dead
/// without knowing it, so it is made anew.
void LidarLink::watch(double now) {
  if (now - watch_.since < service::settings::kLidarWatch_s) return;
  const auto counters = lidar_->counters();
  const Watch before = std::exchange(watch_, {now, counters.at("bytes_in"), counters.at("good")});
  const bool silent = watch_.bytes == before.bytes;
  data_problem_.reset();
  if (watch_.good != before.good) {
    failures_ = 0;
    return;
  }
  data_problem_ = nothing_valid(silent);
  if (silent && address_.network) lose(*data_problem_, now);
}

void LidarLink::step(const Clock& clock) {
  const double now = clock.now();
  open_when_due(now);
  if (!stream_ || !finish_connecting(now)) return;
  const auto bytes = stream_->read();
  if (!bytes) return lose(bytes.error(), now);
  taken_ += bytes.value().size();
  // Read after the bytes: with a time from before, a pause in between would make them earlier than they were
  // sent, and drivers that trust the least delay ever seen would date every scan by it for a minute.
  lidar_->on_bytes(bytes.value(), clock.now());
  if (const auto written = stream_->write(lidar_->take_output()); !written) return lose(written.error(), now);
  watch(now);
}

std::vector<Scan> LidarLink::take_scans() {
  std::vector<Scan> out;
  for (drivers::LidarScan& given : lidar_->take_scans())
    if (!given.partial) out.push_back(std::move(given.scan));
  return out;
}

/// A driver that sees what is wrong with the data knows more than that none are valid; one that only misses
/// an answer knows less.
std::optional<Error> LidarLink::problem() const {
  if (problem_) return problem_;
  auto reported = lidar_->problem();
  const bool seen = reported && reported->code == ErrorCode::format;
  return data_problem_ && !seen ? data_problem_ : reported;
}

drivers::Counters LidarLink::counters() const {
  drivers::Counters all = lidar_->counters();
  all["reconnects"] = opened_ > 0 ? opened_ - 1 : 0;
  return all;
}

}  // namespace odomcalib
