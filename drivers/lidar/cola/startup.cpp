#include "drivers/lidar/cola/startup.hpp"

#include <array>

#include "drivers/clean_text.hpp"
#include "drivers/lidar/cola/settings.hpp"

namespace odomcalib::drivers::cola {
namespace {
constexpr unsigned kReady = 1;

Error trouble(const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, "sick", remedy};
}

/// Meaning of the number in an sFA telegram.
std::string refusal_text(unsigned code) {
  static constexpr std::array<const char*, 14> kTexts = {
      "no error",         "access denied", "unknown method", "unknown variable",
      "local condition",  "invalid data",  "unknown error",  "buffer overflow",
      "buffer underflow", "wrong type",    "write denied",   "unknown command",
      "unknown command",  "busy"};
  return code < kTexts.size() ? kTexts[code] : "error " + std::to_string(code);
}

}  // namespace

void Startup::reset() {
  dialogue_.reset();
  step_ = Step::off;
}

std::vector<std::uint8_t> Startup::stop_bytes() const { return encode(dialect_, "sEN LMDscandata", 0); }

void Startup::enter(Step step, double now) {
  step_ = step;
  since_ = now;
  if (step == Step::identify) dialogue_.ask(encode(dialect_, "sRN DeviceIdent"), now, kDialect_s, 1);
  if (step == Step::state) dialogue_.ask(encode(dialect_, "sRN SCdevicestate"), now, kPatience_s, 2);
  if (step == Step::subscribe) dialogue_.ask(encode(dialect_, "sEN LMDscandata", 1), now, kFirstScan_s, 1);
}

void Startup::gave_up(double now) {
  if (step_ == Step::state) return enter(Step::subscribe, now);  // not every model tells its state
  if (step_ == Step::identify) {
    problem_ = trouble("no answer in either dialect of CoLa",
                       "check address and port (2112 or 2111), and whether another program is connected");
    dialect_ = dialect_ == Dialect::binary ? Dialect::ascii : Dialect::binary;
  } else {
    problem_ = trouble("no scans after the request", "check that the sensor measures and is not in error");
  }
  enter(Step::identify, now);
}

void Startup::step(double now) {
  if (step_ == Step::off) return enter(Step::identify, now);
  if (step_ == Step::pause) {
    if (now - since_ >= kPause_s) enter(Step::state, now);
  } else if (step_ == Step::measuring) {
    if (now - since_ > kNoScan_s) enter(Step::identify, now);
  } else {
    dialogue_.step(now);
    if (dialogue_.gave_up()) gave_up(now);
  }
}

void Startup::on_refusal(const Telegram& telegram, double now) {
  Arguments in(telegram.dialect, telegram.arguments);
  const unsigned code = in.number(2);
  if (step_ == Step::identify || step_ == Step::state) return enter(Step::subscribe, now);
  if (step_ != Step::subscribe) return;
  problem_ = trouble("the sensor refuses to send scans: " + refusal_text(code), "the request is repeated");
  enter(Step::pause, now);
}

void Startup::on_state(const Telegram& telegram, double now) {
  Arguments in(telegram.dialect, telegram.arguments);
  const unsigned state = in.number(1);
  if (in.ok() && state == kReady) return enter(Step::subscribe, now);
  problem_ = trouble("the sensor is not ready (state " + std::to_string(state) + ")",
                     "it may still be starting; if it stays, see its display or SOPAS");
  enter(Step::pause, now);
}

void Startup::on_telegram(const Telegram& telegram, double now) {
  if (telegram.scan) {
    // Scans of an earlier subscription may come while the dialogue is still going on.
    if (step_ == Step::subscribe || step_ == Step::measuring) {
      problem_.reset();
      step_ = Step::measuring;
      since_ = now;
    }
    return;
  }
  if (telegram.kind == "sFA") return on_refusal(telegram, now);
  if (step_ == Step::identify && telegram.name == "DeviceIdent") {
    Arguments in(telegram.dialect, telegram.arguments);
    const std::string name = in.counted_text();
    identity_ = "SICK " + clean_text(name) + " " + clean_text(in.counted_text());
    problem_.reset();
    return enter(Step::state, now);
  }
  if (step_ == Step::state && telegram.name == "SCdevicestate") on_state(telegram, now);
}

}  // namespace odomcalib::drivers::cola
