#include "drivers/lidar/scip/startup.hpp"

#include <array>
#include <cstdio>

#include "drivers/clean_text.hpp"
#include "drivers/lidar/scip/settings.hpp"

namespace odomcalib::drivers::scip {
namespace {

std::vector<std::uint8_t> line(const std::string& text) {
  std::vector<std::uint8_t> out(text.begin(), text.end());
  out.push_back('\n');
  return out;
}

Error trouble(const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, "hokuyo", remedy};
}

}  // namespace

void Startup::reset() {
  dialogue_.reset();
  step_ = Step::off;
}

std::string Startup::measure_command() const {
  std::array<char, 32> text{};
  (void)std::snprintf(text.data(), text.size(), "%s%04u%04u01000", intensities_ ? "ME" : "MD",
                      parameters_ ? parameters_->first % 10'000 : 0,
                      parameters_ ? parameters_->last % 10'000 : 0);
  return text.data();
}

void Startup::enter(Step step, double now) {
  step_ = step;
  since_ = now;
  heard_at_ = now;
  if (step == Step::quiet) {
    dialogue_.say(line("QT"));
    dialogue_.say(line("TM2"));
  }
  if (step == Step::version) dialogue_.ask(line("VV"), now, kPatience_s, 3);
  if (step == Step::parameters) dialogue_.ask(line("PP"), now, kPatience_s, 3);
  if (step == Step::laser) dialogue_.ask(line("BM"), now, kPatience_s, 3);
  if (step == Step::measure) dialogue_.ask(line(measure_command()), now, kSpinUp_s, 1);
}

void Startup::gave_up(double now) {
  if (step_ == Step::measure)
    problem_ = trouble("no measurements after the request", "check that the motor turns");
  else
    problem_ = trouble("no answer", "check power, wiring, baud rate and lidar.type");
  // An old sensor may still speak protocol 1.1.
  if (step_ == Step::version) dialogue_.say(line("SCIP2.0"));
  enter(Step::quiet, now);
}

void Startup::step(double now, bool heard) {
  if (heard) heard_at_ = now;
  switch (step_) {
    case Step::off:
      return enter(Step::quiet, now);
    case Step::quiet:
      if (now - heard_at_ >= kSilence_s || now - since_ >= kMostQuiet_s) enter(Step::version, now);
      return;
    case Step::pause:
      if (now - since_ >= kPause_s) enter(Step::quiet, now);
      return;
    case Step::measuring:
      if (now - since_ > kNoScan_s) enter(Step::quiet, now);
      return;
    default:
      dialogue_.step(now);
      if (dialogue_.gave_up()) gave_up(now);
  }
}

void Startup::refused(const Reply& reply, const std::string& what, double now) {
  problem_ = trouble(what + " (status " + clean_text(reply.status) + ")",
                     reply.status == "10" ? "the laser is off; it may still be spinning up"
                                          : "it is tried again; switch the sensor off and on if it stays");
  enter(Step::pause, now);
}

/// Status 00 only says that scans will come; 99 is one.
void Startup::on_stream(const Reply& reply, double now) {
  if (reply.status == "99") {
    problem_.reset();
    step_ = Step::measuring;
    since_ = now;
  } else if (reply.status != "00") {
    refused(reply, "the sensor does not measure", now);
  }
}

void Startup::on_reply(const Reply& reply, double now) {
  const std::string name = reply.echo.substr(0, 2);
  if (step_ == Step::version && name == "VV" && reply.status == "00") {
    const auto fields = fields_of(reply.lines);
    const auto text = [&](const char* key) { return fields.contains(key) ? fields.at(key) : std::string(); };
    identity_ = clean_text(text("PROD") + " firmware " + text("FIRM") + " serial " + text("SERI"));
    enter(Step::parameters, now);
  } else if (step_ == Step::parameters && name == "PP" && reply.status == "00") {
    parameters_ = read_parameters(reply.lines);
    if (!parameters_) return refused(reply, "the sensor's parameters make no sense", now);
    enter(Step::laser, now);
  } else if (step_ == Step::laser && name == "BM") {
    if (reply.status != "00" && reply.status != "02")
      return refused(reply, "the laser cannot be switched on", now);
    enter(Step::measure, now);
  } else if ((step_ == Step::measure || step_ == Step::measuring) && name == measure_command().substr(0, 2)) {
    on_stream(reply, now);
  }
}

}  // namespace odomcalib::drivers::scip
