#include "tests/sim/wires/scip_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

constexpr double kSweep = 1260.0 / 1440.0;  // of a turn, from the rear to the last step

char sum_of(const std::string& text) {
  int sum = 0;
  for (const char c : text) sum += c;
  return static_cast<char>(sum % 64 + '0');
}

std::string characters(unsigned value, int count) {
  std::string out(static_cast<std::size_t>(count), '0');
  for (int i = count - 1; i >= 0; --i, value /= 64)
    out[static_cast<std::size_t>(i)] = static_cast<char>('0' + value % 64);
  return out;
}

}  // namespace

void ScipDevice::reply(const std::string& echo, const std::string& status,
                       const std::vector<std::string>& lines, double ready) {
  std::string out = echo + "\n" + status + sum_of(status) + "\n";
  for (const std::string& line : lines) {
    const bool parameter = echo == "VV" || echo == "PP";  // their semicolons are not summed
    out += line + sum_of(parameter ? line.substr(0, line.size() - 1) : line) + "\n";
  }
  send(out + "\n", ready);
}

void ScipDevice::on_line(const std::string& line, double now) {
  const double soon = now + 0.002;
  const std::string name = line.substr(0, 2);
  if (name == "QT") laser_ = false, stream_.clear(), reply(line, "00", {}, soon);
  if (name == "VV")
    reply(line, "00",
          {"VEND:Nobody;", "PROD:" + options_.product + ";", "FIRM:1.0;", "PROT:SCIP 2.2;", "SERI:H7;"},
          soon);
  if (name == "PP")
    reply(line, "00",
          {"MODL:SIM;", "DMIN:23;", "DMAX:60000;", "ARES:1440;", "AMIN:0;", "AMAX:1080;", "AFRT:540;",
           "SCAN:2400;"},
          soon);
  if (name == "TM") reply(line, laser_ ? "0E" : "00", {}, soon);
  if (name == "BM") {
    const bool ready = now >= options_.ready_at;
    reply(line, !ready ? "01" : laser_ ? "02" : "00", {}, soon);
    laser_ = ready;
  }
  if (name != "MD" && name != "ME") return;
  reply(line, laser_ ? "00" : "10", {}, soon);
  if (!laser_) return;
  stream_ = line;
  next_rear_ = std::ceil(soon / options_.period) * options_.period;
}

void ScipDevice::from_host(std::string_view bytes, double now) {
  input_ += bytes;
  for (std::size_t end = input_.find('\n'); end != std::string::npos; end = input_.find('\n')) {
    on_line(input_.substr(0, end), now);
    input_.erase(0, end + 1);
  }
}

void ScipDevice::advance(double now) {
  while (streaming() && next_rear_ + kSweep * options_.period <= now) {
    send_scan(next_rear_);
    next_rear_ += options_.period;
  }
}

/// Step k looks k quarter degrees from the rear plus 45 degrees, and is measured when the mirror is there.
void ScipDevice::send_scan(double rear) {
  std::string data;
  for (int step = 0; step <= 1080; ++step) {
    const double t = rear + options_.period * (step + 180) / 1440.0;
    const double direction = (step - 540) * std::numbers::pi / 720.0;
    const double range = moving_wall(direction, std::min(t, options_.still_after));
    data += characters(static_cast<unsigned>(std::lround(1000.0 * range)), 3);
    if (stream_.starts_with("ME")) data += characters(1000 + static_cast<unsigned>(step), 3);
  }
  const double device_ms = std::floor(1000.0 * (options_.clock_zero + rear));
  std::vector<std::string> lines{characters(static_cast<unsigned>(std::fmod(device_ms, 16'777'216.0)), 4)};
  for (std::size_t at = 0; at < data.size(); at += 64) lines.push_back(data.substr(at, 64));
  reply(stream_, "99", lines, rear + kSweep * options_.period + 0.0005);
}

}  // namespace odomcalib::sim
