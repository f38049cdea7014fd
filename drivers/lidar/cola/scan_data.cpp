#include "drivers/lidar/cola/scan_data.hpp"

#include <cmath>

#include "drivers/lidar/cola/settings.hpp"

namespace odomcalib::drivers::cola {
namespace {
constexpr std::size_t kNameLength = 5;

/// False when what was read cannot be true.
bool read_channel(Arguments& in, std::size_t value_bytes, Channel& out) {
  out.name = in.fixed_text(kNameLength);
  out.factor = in.real();
  out.offset = in.real();
  out.start = in.signed_number(4);
  out.step = in.number(2);
  const std::uint32_t count = in.number(2);
  if (!in.ok() || count > kMostValues) return false;
  for (std::uint32_t i = 0; i < count && in.ok(); ++i)
    out.values.push_back(static_cast<std::uint16_t>(in.number(value_bytes)));
  return in.ok();
}

bool read_channels(Arguments& in, std::size_t value_bytes, ScanData& out) {
  const std::uint32_t count = in.number(2);
  if (!in.ok() || count > kMostChannels) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    Channel channel;
    if (!read_channel(in, value_bytes, channel)) return false;
    out.channels.push_back(std::move(channel));
  }
  return true;
}

bool read_encoders(Arguments& in) {
  const std::uint32_t count = in.number(2);
  if (!in.ok() || count > kMostEncoders) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    (void)in.number(4);
    (void)in.number(2);
  }
  return in.ok();
}

void read_header(Arguments& in, ScanData& out) {
  (void)in.number(2);  // version
  (void)in.number(2);  // device number
  out.serial_number = in.number(4);
  const unsigned high = in.number(1);
  out.status = high << 8U | in.number(1);
  out.telegram_counter = in.number(2);
  out.scan_counter = in.number(2);
  out.started_us = in.number(4);
  out.sent_us = in.number(4);
  for (int i = 0; i < 4; ++i) (void)in.number(1);  // digital inputs, outputs
  out.layer = in.signed_number(2);
  out.turns_chz = in.number(4);
  out.measurements_hundred_hz = in.number(4);
}

bool is_sensible(const ScanData& data) {
  const Channel* distances = data.find("DIST1");
  if (data.turns_chz < kSlowest_chz || data.turns_chz > kFastest_chz || data.measurements_hundred_hz == 0)
    return false;
  if (distances == nullptr || distances->values.size() < 2 || distances->step == 0) return false;
  const double span = true_step(distances->step) * static_cast<double>(distances->values.size() - 1);
  return span <= kMostSpan_deg && distances->factor > 0.0F && std::abs(distances->start) <= 3'600'000;
}

}  // namespace

const Channel* ScanData::find(const std::string& name) const {
  for (const Channel& channel : channels)
    if (channel.name == name) return &channel;
  return nullptr;
}

double true_step(std::uint32_t step) {
  const double thirds = 3.0 * step;
  const double nearest = std::round(thirds / 2500.0) * 2500.0;
  const bool rounded = std::abs(thirds - nearest) <= 1.0;
  return 1e-4 * (rounded ? nearest / 3.0 : step);
}

std::optional<ScanData> read_scan_data(Dialect dialect, Bytes bytes) {
  Arguments in(dialect, bytes);
  ScanData out;
  read_header(in, out);
  const bool whole = in.ok() && read_encoders(in) && read_channels(in, 2, out) && read_channels(in, 1, out);
  return whole && is_sensible(out) ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace odomcalib::drivers::cola
