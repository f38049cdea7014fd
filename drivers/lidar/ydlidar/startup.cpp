#include "drivers/lidar/ydlidar/startup.hpp"

#include "drivers/clean_text.hpp"
#include "drivers/lidar/ydlidar/settings.hpp"

namespace odomcalib::drivers::ydlidar {
namespace {

constexpr std::uint8_t kStart = 0xA5;
constexpr std::uint8_t kScan = 0x60, kStop = 0x65, kInfo = 0x90, kHealth = 0x92;  // commands
constexpr std::uint8_t kInfoAnswer = 0x04, kHealthAnswer = 0x06;

Error trouble(const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, "ydlidar", remedy};
}

}  // namespace

std::vector<std::uint8_t> Startup::stop_bytes() { return {kStart, kStop}; }

void Startup::reset() {
  dialogue_.reset();
  step_ = Step::off;
}

void Startup::enter(Step step, double now) {
  step_ = step;
  silent_since_ = now;
  if (step == Step::stop) dialogue_.ask({kStart, kStop}, now, kQuiet_s, 1);
  if (step == Step::info) dialogue_.ask({kStart, kInfo}, now, kPatience_s, 3);
  if (step == Step::health) dialogue_.ask({kStart, kHealth}, now, kPatience_s, 3);
  if (step == Step::scan) dialogue_.ask({kStart, kScan}, now, kSpinUp_s, 1);
}

void Startup::gave_up(double now) {
  if (step_ == Step::stop) return enter(Step::info, now);
  if (step_ == Step::health) return enter(Step::scan, now);
  problem_ = step_ == Step::info
                 ? trouble("no answer to the request for information",
                           "check power, wiring, baud rate and model: a single-channel model does not answer")
                 : trouble("no measurements after the scan request",
                           "does the motor turn? it needs DTR or the supply of its USB board");
  enter(step_ == Step::info ? Step::scan : Step::stop, now);
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
  if (step_ != Step::scan && step_ != Step::measuring) return;
  if (step_ == Step::scan) problem_.reset();
  enter(Step::measuring, now);
}

void Startup::on_info(Bytes payload, double now) {
  ByteReader reader(payload);
  const unsigned model = reader.u8(), minor = reader.u8(), major = reader.u8(), hardware = reader.u8();
  const Bytes serial = reader.take(16);
  if (!reader.ok()) return;
  std::string digits;  // one decimal digit a byte
  for (const std::uint8_t byte : serial) digits += byte < 10 ? std::to_string(byte) : hex_text({&byte, 1});
  identity_ = "YDLIDAR model " + std::to_string(model) + " firmware " + std::to_string(major) + "." +
              std::to_string(minor) + " hardware " + std::to_string(hardware) + " serial " + digits;
  enter(Step::health, now);
}

void Startup::on_health(Bytes payload, double now) {
  ByteReader reader(payload);
  const unsigned status = reader.u8(), code = reader.u16();
  if (!reader.ok()) return;
  if (status >= 2)
    problem_ = trouble("the lidar reports error " + std::to_string(code), "switch its power off and on");
  enter(Step::scan, now);
}

void Startup::on_answer(const Answer& answer, double now) {
  if (step_ == Step::info && answer.type == kInfoAnswer) on_info(answer.payload, now);
  if (step_ == Step::health && answer.type == kHealthAnswer) on_health(answer.payload, now);
}

}  // namespace odomcalib::drivers::ydlidar
