#include "tests/sim/wires/serial_devices.hpp"

#include <cstdint>
#include <sstream>

namespace odomcalib::sim {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

/// Low byte first.
void put(std::string& out, std::int64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i)
    out += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU);
}

unsigned byte_at(const std::string& text, std::size_t at) { return static_cast<unsigned char>(text[at]); }

/// The manual's algorithm: pairs are added, high byte first, a last single byte is XORed in.
unsigned pioneer_sum(const std::string& data) {
  unsigned sum = 0;
  std::size_t i = 0;
  for (; i + 1 < data.size(); i += 2) sum = (sum + (byte_at(data, i) << 8U) + byte_at(data, i + 1)) & 0xFFFFU;
  return i < data.size() ? sum ^ byte_at(data, i) : sum;
}

}  // namespace

std::string SerialDevice::advance(double now) {
  wheels_.advance(last_ > 0.0 ? now - last_ : 0.0);
  last_ = now;
  watch(now);
  std::string out;
  talk(now, out);
  return silent ? std::string() : out;
}

void ArduinoBoard::receive(const std::string& bytes, double now) {
  for (const char c : bytes) {
    if (c != '\r') {
      line_ += c;
      continue;
    }
    execute(now);
    line_.clear();
  }
}

void ArduinoBoard::execute(double now) {
  std::istringstream words(line_);
  std::string command;
  words >> command;
  std::ostringstream answer;
  if (command == "e") {
    answer << wheels_.count(0, 8384.0) << " " << wheels_.count(1, 8384.0);
  } else if (command == "m") {
    double left = 0.0, right = 0.0;
    words >> left >> right;
    wheels_.rate = {left * 30.0 / 8384.0 * kTurn_rad, right * 30.0 / 8384.0 * kTurn_rad};
    moved_at_ = now;
    answer << "OK";
  } else {
    answer << "Invalid Command";
  }
  answers_ += answer.str() + "\r\n";
}

void ArduinoBoard::watch(double now) {
  if (now - moved_at_ > 2.0) wheels_.rate = {};
}

void ArduinoBoard::talk(double /*now*/, std::string& out) { out.swap(answers_); }

void PioneerBase::receive(const std::string& bytes, double now) {
  input_ += bytes;
  while (input_.size() >= 3) {
    if (byte_at(input_, 0) != 0xFA || byte_at(input_, 1) != 0xFB) {
      input_.erase(0, 1);
      continue;
    }
    const std::size_t length = byte_at(input_, 2);
    if (input_.size() < 3 + length) return;
    const std::string data = input_.substr(3, length - 2);
    const unsigned told = byte_at(input_, length + 1) << 8U | byte_at(input_, length + 2);
    input_.erase(0, 3 + length);
    if (told == pioneer_sum(data))
      execute(data, now);
    else
      ++bad_packets_;
  }
}

void PioneerBase::send(const std::string& data) {
  const unsigned sum = pioneer_sum(data);
  answers_ += "\xFA\xFB";
  answers_ += static_cast<char>(data.size() + 2);
  answers_ += data;
  answers_ += static_cast<char>(sum >> 8U);
  answers_ += static_cast<char>(sum & 0xFFU);
}

void PioneerBase::execute(const std::string& data, double now) {
  const unsigned command = byte_at(data, 0);
  heard_at_ = now;
  if (!open_ && command <= 2 && data.size() == 1) {
    if (static_cast<int>(command) != synchronised_) return;
    const std::string zero(1, '\0');
    if (command == 2)
      return ++synchronised_, send("\x02" + std::string("Robot") + zero + "Pioneer" + zero + "p3dx" + zero);
    ++synchronised_;
    return send(std::string(1, static_cast<char>(command)));
  }
  const int magnitude = data.size() >= 4 ? static_cast<int>(byte_at(data, 2) | byte_at(data, 3) << 8U) : 0;
  const int argument = data.size() >= 4 && byte_at(data, 1) == 0x1B ? -magnitude : magnitude;
  if (command == 1 && synchronised_ == 3) open_ = true;
  if (!open_) return;
  if (command == 4) enabled_ = argument != 0;
  if (command == 11) speed_ = 1e-3 * argument;
  if (command == 21) turn_ = argument * kTurn_rad / 360.0;
  if (command == 55 || command == 29) speed_ = turn_ = 0.0;
  if (command == 19) encoders_ = argument == 2;
  if (command == 18 && tells_configuration) send_configuration();
}

void PioneerBase::send_configuration() {
  const std::string zero(1, '\0');
  std::string data = "\x20" + std::string("Pioneer") + zero + "p3dx" + zero + "SN4242" + zero;
  data += std::string(11, '\0') + "Miss Agnes" + zero + std::string(10, '\0');
  put(data, 16570, 2);  // RevCount
  put(data, watchdog_ms, 2);
  data += std::string(39, '\0');  // to the gyro byte
  put(data, -120, 2);             // DriftFactor
  data += std::string(2, '\0');
  put(data, 132, 2);  // TicksMM
  put(data, 110, 2);  // shutdown voltage
  send(data);
}

void PioneerBase::watch(double now) {
  if (now - heard_at_ > 2.0) speed_ = turn_ = 0.0;
  const bool moves = open_ && enabled_ && !emergency_stop;
  const double speed = moves ? speed_ : 0.0, turn = moves ? turn_ : 0.0;
  wheels_.rate = {(speed - 0.1905 * turn) / 0.0975, (speed + 0.1905 * turn) / 0.0975};
}

void PioneerBase::talk(double /*now*/, std::string& out) {
  slot_ = (slot_ + 1) % 100;  // each 100 ms
  if (open_ && slot_ == 20) {
    std::string status(1, static_cast<char>(wheels_.rate[0] == 0.0 && wheels_.rate[1] == 0.0 ? 0x32 : 0x33));
    for (const int value : {10, 20, 1024, 0, 0}) put(status, value, 2);
    status += static_cast<char>(123);
    put(status, 0, 2);
    put(status, 0, 2);
    put(status, (enabled_ ? 1 : 0) | (emergency_stop ? 0x20 : 0), 2);
    status += std::string(2, '\0');
    send(status);
  }
  if (open_ && encoders_ && slot_ == 21) {
    std::string encoders = "\x90";
    put(encoders, wheels_.count(0, 82500.0), 4);
    put(encoders, wheels_.count(1, 82500.0), 4);
    send(encoders);
  }
  out.swap(answers_);
}

}  // namespace odomcalib::sim
