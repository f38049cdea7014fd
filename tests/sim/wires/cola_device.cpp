#include "tests/sim/wires/cola_device.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace odomcalib::sim {

/// A field: binary, or a blank and hexadecimal digits.
std::string ColaDevice::number(std::uint64_t value, int bytes) const {
  if (options_.binary) return big(value, bytes);
  std::array<char, 24> text{};
  (void)std::snprintf(text.data(), text.size(), " %llX", static_cast<unsigned long long>(value));
  return text.data();
}

void ColaDevice::reply(const std::string& text, const std::string& binary, const std::string& ascii,
                       double ready) {
  if (!options_.binary) return send("\x02" + text + ascii + "\x03", ready);
  const std::string payload = text + " " + binary;
  unsigned sum = 0;
  for (const char c : payload) sum ^= static_cast<unsigned char>(c);
  send("\x02\x02\x02\x02" + big(payload.size(), 4) + payload + static_cast<char>(sum), ready);
}

void ColaDevice::on_command(const std::string& command, double now) {
  const double soon = now + 0.001;
  if (command == "sRN DeviceIdent")
    reply("sRA DeviceIdent", big(7, 2) + "SIM 111" + big(3, 2) + "1.0", " 7 SIM 111 3 1.0", soon);
  if (command == "sRN SCdevicestate") {
    const bool ready = now >= options_.ready_at;
    reply("sRA SCdevicestate", big(ready ? 1 : 0, 1), ready ? " 1" : " 0", soon);
  }
  if (!command.starts_with("sEN LMDscandata ")) return;
  if (options_.refuses) return reply("sFA", big(13, 2), " D", soon);
  streaming_ = command.back() == '\x01' || command.back() == '1';
  reply("sEA LMDscandata", big(streaming_ ? 1 : 0, 1), streaming_ ? " 1" : " 0", soon);
  next_ = std::ceil(soon / options_.period) * options_.period;
}

void ColaDevice::from_host(std::string_view bytes, double now) {
  input_ += bytes;
  while (input_.size() > 9) {
    const bool binary = input_.starts_with("\x02\x02\x02\x02");
    const std::size_t length = binary ? static_cast<unsigned char>(input_[7]) : input_.find('\x03') - 1;
    const std::string command = input_.substr(binary ? 8 : 1, length);
    if (binary == options_.binary) on_command(command, now);
    input_.erase(0, length + (binary ? 9 : 2));
  }
}

void ColaDevice::advance(double now) {
  for (; streaming_ && next_ + 0.75 * options_.period <= now; next_ += options_.period) send_scan(next_);
}

/// The sweep takes three quarters of a turn. What the device calls its start is 1.5 ms before the sweep's
/// end.
void ColaDevice::send_scan(double first_beam) {
  const double started = first_beam + 0.75 * options_.period - 0.0015;
  const double sent = started + 0.0031;
  const auto stamp = [&](double t) {
    return number(static_cast<std::uint32_t>(std::fmod(1e6 * (options_.clock_zero + t), 4294967296.0)), 4);
  };
  counter_ = (counter_ + 1) % 65'536;
  std::string out = number(1, 2) + number(1, 2) + number(0x1140B7A, 4) + number(0, 1) + number(0, 1) +
                    number(counter_, 2) + number(counter_, 2) + stamp(started) + stamp(sent);
  for (int i = 0; i < 4; ++i) out += number(0, 1);
  out += number(0, 2) + number(5000, 4) + number(360, 4) + number(0, 2) + number(1, 2);
  out += (options_.binary ? "" : " ") + std::string("DIST1") + number(0x3F800000, 4) + number(0, 4) +
         number(0xFFF92230, 4) + number(5000, 2) + number(541, 2);
  for (int beam = 0; beam < 541; ++beam) {
    // 90 degrees of the device are straight ahead.
    const double direction = (-45.0 + 0.5 * beam - 90.0) * std::numbers::pi / 180.0;
    const double t = first_beam + options_.period * beam / 720.0;
    const long mm = beam % 100 == 7 ? 2 : std::lround(1000.0 * moving_wall(direction, t));
    out += number(static_cast<std::uint64_t>(mm), 2);
  }
  for (int i = 0; i < 6; ++i) out += number(0, 2);
  reply("sSN LMDscandata", out, out, sent + 0.0002);
}

}  // namespace odomcalib::sim
