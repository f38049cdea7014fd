#include "drivers/lidar/rplidar/startup.hpp"

#include <array>
#include <cstdio>

#include "drivers/clean_text.hpp"
#include "drivers/lidar/rplidar/commands.hpp"
#include "drivers/lidar/rplidar/packet.hpp"
#include "drivers/lidar/rplidar/settings.hpp"

namespace odomcalib::drivers::rplidar {
namespace {

using ByteString = std::vector<std::uint8_t>;
constexpr unsigned kConfigurable = 1U << 8U | 24U;  // firmware 1.24 knows Command::configuration
constexpr unsigned kExpress = 1U << 8U | 17U;       // firmware 1.17 knows Command::express_scan

Error trouble(const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, "rplidar", remedy};
}

void put(ByteString& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

ByteString setting_request(Setting setting, unsigned mode, bool with_mode) {
  ByteString payload;
  put(payload, static_cast<std::uint32_t>(setting), 4);
  if (with_mode) put(payload, mode, 2);
  return encode(Command::configuration, payload);
}

ByteString word_request(Command command, unsigned value) {
  ByteString payload;
  put(payload, value, command == Command::motor_board ? 4 : 2);
  return encode(command, payload);
}

ByteString express_request(unsigned mode) {
  const std::array<std::uint8_t, 5> payload = {static_cast<std::uint8_t>(mode), 0, 0, 0, 0};
  return encode(Command::express_scan, payload);
}

}  // namespace

void Startup::reset() {
  dialogue_.reset();
  step_ = Step::off;
  was_reset_ = false;
}

std::vector<std::uint8_t> Startup::motor_command(bool run) const {
  const unsigned family = model_ >> 4U;
  if (family == 2 || family == 3) return word_request(Command::motor_pwm, run ? kPwm : 0);
  if (family >= 6) return word_request(Command::motor_speed, run ? kRpm : 0);
  return {};
}

std::vector<std::uint8_t> Startup::stop_bytes() const {
  ByteString out = encode(Command::stop);
  const ByteString motor = motor_command(false);
  out.insert(out.end(), motor.begin(), motor.end());
  return out;
}

std::vector<std::uint8_t> Startup::request_of(Step step) const {
  switch (step) {
    case Step::stop:
      return encode(Command::stop);
    case Step::info:
      return encode(Command::info);
    case Step::health:
      return encode(Command::health);
    case Step::restart:
      return encode(Command::reset);
    case Step::typical_mode:
      return setting_request(Setting::typical_mode, 0, false);
    case Step::answer_type:
      return setting_request(Setting::packet_type, scan_mode_, true);
    case Step::sample:
      return setting_request(Setting::sample_time, scan_mode_, true);
    case Step::range:
      return setting_request(Setting::range_max, scan_mode_, true);
    case Step::sample_legacy:
      return encode(Command::sample_time);
    case Step::motor_board:
      return word_request(Command::motor_board, 0);
    case Step::motor:
      return motor_command(true);
    case Step::scan:
      return packet_type_ == static_cast<std::uint8_t>(PacketType::standard) ? encode(Command::scan)
                                                                             : express_request(scan_mode_);
    case Step::off:
    case Step::measuring:
      break;
  }
  return {};
}

void Startup::enter(Step step, double now) {
  step_ = step;
  silent_since_ = now;
  if (step == Step::motor) {
    dialogue_.say(request_of(Step::motor));
    return enter(Step::scan, now);
  }
  const bool waits = step == Step::stop || step == Step::restart || step == Step::scan;
  const double patience = step == Step::stop      ? kQuiet_s
                          : step == Step::restart ? kReboot_s
                          : step == Step::scan    ? kSpinUp_s
                                                  : kPatience_s;
  if (step != Step::measuring) dialogue_.ask(request_of(step), now, patience, waits ? 1 : 3);
}

Startup::Step Startup::motor_step() const {
  const unsigned family = model_ >> 4U;
  return family == 2 || family == 3 ? Step::motor_board : Step::motor;
}

Startup::Step Startup::first_mode_step() const {
  if (mode_ == Mode::standard || firmware_ < kExpress) return Step::sample_legacy;
  return mode_ == Mode::express || firmware_ < kConfigurable ? Step::sample_legacy : Step::typical_mode;
}

void Startup::gave_up(double now) {
  switch (step_) {
    case Step::stop:
      return enter(Step::info, now);
    case Step::health:  // not every firmware answers
      return enter(first_mode_step(), now);
    case Step::typical_mode:
    case Step::answer_type:
      return enter(Step::sample_legacy, now);
    case Step::sample:
    case Step::range:
    case Step::sample_legacy:
      return enter(motor_step(), now);
    case Step::motor_board:
      return enter(Step::scan, now);
    case Step::scan:
      problem_ = trouble("no measurements after the scan request", "does the motor turn? check its supply");
      break;
    case Step::info:
      problem_ = trouble("no answer to the request for information",
                         "check power, wiring and baud rate (A1: 115200, A3 and S1: 256000, C1: 460800, S2 "
                         "and S3: 1000000)");
      break;
    default:
      break;
  }
  enter(Step::stop, now);
}

void Startup::step(double now) {
  if (step_ == Step::off) return enter(Step::stop, now);
  if (step_ == Step::measuring) {
    if (now - silent_since_ > kSilence_s) enter(Step::stop, now);
    return;
  }
  dialogue_.step(now);
  if (dialogue_.gave_up()) gave_up(now);
}

void Startup::on_measurements(double now) {
  if (discarding()) return;
  if (step_ == Step::scan) problem_.reset();
  if (step_ == Step::scan || step_ == Step::measuring) enter(Step::measuring, now);
}

void Startup::on_info(Bytes payload, double now) {
  ByteReader reader(payload);
  model_ = reader.u8();
  const unsigned minor = reader.u8(), major = reader.u8(), hardware = reader.u8();
  const std::string serial = hex_text(reader.take(16));
  if (!reader.ok()) return;
  firmware_ = major << 8U | minor;
  std::array<char, 80> text{};
  (void)std::snprintf(text.data(), text.size(), "RPLIDAR model %02Xh firmware %u.%02u hardware %u serial ",
                      model_, major, minor, hardware);
  identity_ = text.data() + serial;
  enter(Step::health, now);
}

void Startup::on_health(Bytes payload, double now) {
  ByteReader reader(payload);
  const unsigned status = reader.u8(), code = reader.u16();
  if (!reader.ok()) return;
  if (status < 2) return enter(first_mode_step(), now);
  problem_ = trouble(
      "the lidar reports error " + std::to_string(code),
      was_reset_ ? "switch its power off and on; replace it if that does not help" : "it is being reset");
  enter(was_reset_ ? Step::stop : Step::restart, now);
  was_reset_ = true;
}

void Startup::on_configuration(Bytes payload, double now) {
  ByteReader reader(payload);
  const auto setting = static_cast<Setting>(reader.u32());
  if (!reader.ok()) return;
  if (step_ == Step::typical_mode && setting == Setting::typical_mode) {
    scan_mode_ = reader.u16();
    enter(reader.ok() ? Step::answer_type : Step::sample_legacy, now);
  } else if (step_ == Step::answer_type && setting == Setting::packet_type) {
    packet_type_ = reader.u8();
    enter(find_format(packet_type_) != nullptr ? Step::sample : Step::sample_legacy, now);
  } else if (step_ == Step::sample && setting == Setting::sample_time) {
    sample_s_ = reader.u32() / 256.0 * 1e-6;
    enter(Step::range, now);
  } else if (step_ == Step::range && setting == Setting::range_max) {
    range_max_m_ = reader.u32() / 256.0;
    enter(motor_step(), now);
  }
}

void Startup::on_sample_time(Bytes payload, double now) {
  ByteReader reader(payload);
  const unsigned standard_us = reader.u16(), express_us = reader.u16();
  const bool express = mode_ != Mode::standard && firmware_ >= kExpress;
  packet_type_ = static_cast<std::uint8_t>(express ? PacketType::express : PacketType::standard);
  scan_mode_ = 0;
  if (reader.ok()) sample_s_ = 1e-6 * (express ? express_us : standard_us);
  enter(motor_step(), now);
}

void Startup::on_answer(std::uint8_t type, Bytes payload, double now) {
  const auto answer = static_cast<AnswerType>(type);
  if (step_ == Step::info && answer == AnswerType::info) return on_info(payload, now);
  if (step_ == Step::health && answer == AnswerType::health) return on_health(payload, now);
  if (answer == AnswerType::configuration) return on_configuration(payload, now);
  if (step_ == Step::sample_legacy && answer == AnswerType::sample_time) return on_sample_time(payload, now);
  if (step_ == Step::motor_board && answer == AnswerType::motor_board) {
    ByteReader reader(payload);
    enter((reader.u32() & 1U) != 0 ? Step::motor : Step::scan, now);
  }
}

}  // namespace odomcalib::drivers::rplidar
