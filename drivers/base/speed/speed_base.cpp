// The controller (drivers/base/controller.hpp) around a SpeedProtocol: presence, commands that grow old,
// stops, rest, counts that stand still.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/base/motion/motion_cycle.hpp"
#include "drivers/base/motion/settings.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/base/speed/settings.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

class SpeedBase final : public Controller, private MotionDevice {
 public:
  SpeedBase(Profile profile, std::unique_ptr<SpeedProtocol> protocol);

  [[nodiscard]] Wire wire() const override { return protocol_->wire(); }
  void on_connected(std::optional<unsigned> baud) override { protocol_->on_connected(baud); }
  void on_frame(const CanFrame& frame) override;
  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  void on_time(double now) override;
  std::vector<CanFrame> take_frames() override { return protocol_->take_frames(); }
  std::vector<std::uint8_t> take_bytes() override { return protocol_->take_bytes(); }
  std::vector<TickSample> take_ticks() override { return counts_.take(); }
  std::vector<ControllerEvent> take_events() override { return motion_.take_events(); }

  [[nodiscard]] ControllerState state() const override;
  void enable(double now) override;
  void disable(double now) override;
  Result<void> command(double left_rad_s, double right_rad_s, double now) override;
  void quick_stop(double now) override;
  [[nodiscard]] double watchdog_time() const override;
  [[nodiscard]] bool at_rest() const override { return motion_.at_rest(now_); }

  /// These devices hold no geometry that this program could write: reading gives none, the rest is refused.
  /// Where a device tells its command time-out, a reading asks for it again.
  Result<void> start_read_parameters(double now) override;
  Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) override;
  Result<void> start_store(double now) override;
  std::optional<ParameterJobResult> take_job_result() override { return std::exchange(job_result_, {}); }

  [[nodiscard]] std::optional<Identity> identity() const override { return protocol_->identity(); }
  [[nodiscard]] std::optional<double> supply_voltage() const override { return supply_voltage_; }
  [[nodiscard]] RobotDescription description() const override { return profile_.robot; }
  [[nodiscard]] std::vector<Capability> capabilities() const override;
  [[nodiscard]] Counters counters() const override;

 private:
  void event(const std::string& code, const std::string& text, bool stop);
  void take_news();
  void on_other_master();
  void on_count(const SideCount& count);
  void serve_reading();
  [[nodiscard]] std::optional<Error> timeout_changed() const;
  void check_presence();
  void check_device();
  [[nodiscard]] std::string enable_refusal() const override;
  [[nodiscard]] bool follows() const override;
  [[nodiscard]] std::string enable_failure() const override;
  void begin_enabling() override { asked_ = false; }
  void engage() override;
  void drive(double left_rad_s, double right_rad_s) override;
  void stop() override { protocol_->stop(); }
  void release() override { protocol_->release(); }
  double idle() override;
  [[nodiscard]] Error refused(const std::string& what, const std::string& remedy) const;

  const Profile profile_;
  std::unique_ptr<SpeedProtocol> protocol_;
  MotionCycle motion_;
  WheelCounts counts_;
  double now_ = 0.0, greet_due_ = 0.0;
  std::array<double, 2> counted_at_{-1e9, -1e9};  ///< s
  double last_other_master_ = -1e9;               ///< s
  std::uint64_t other_master_ = 0;
  std::optional<double> supply_voltage_;  ///< V
  bool present_ = false;
  bool asked_ = false;  // for torque
  std::string last_fault_;
  struct Reading {
    double ends_at = 0.0;          ///< s
    std::uint64_t reports = 0;     ///< how often it had reported its settings before
    std::optional<double> before;  ///< s, the time-out
  };
  std::optional<Reading> reading_;
  std::optional<ParameterJobResult> job_result_;
};

using namespace speed;

std::size_t index(Side side) { return static_cast<std::size_t>(side); }

/// Messages of the tables that only somebody who commands the device sends.
constexpr std::array kCommands = {"motion_command", "control_mode", "set_state", "controller_mode",
                                  "input_speed",    "set_current",  "set_rpm"};

/// Names in the tables of the voltage that the device runs on.
constexpr std::array kVoltages = {"battery_V", "voltage_V", "input_voltage_V"};

std::optional<double> voltage_in(const DeviceMessage& message) {
  for (const MessageField& field : message.fields)
    if (std::find(kVoltages.begin(), kVoltages.end(), field.name) != kVoltages.end()) return field.number;
  return std::nullopt;
}

bool is_command(const DeviceMessage& message) {
  return std::find(kCommands.begin(), kCommands.end(), message.name) != kCommands.end();
}

}  // namespace

SpeedBase::SpeedBase(Profile profile, std::unique_ptr<SpeedProtocol> protocol)
    : profile_(std::move(profile)),
      protocol_(std::move(protocol)),
      motion_(*this,
              {profile_.name, profile_.max_rpm * std::numbers::pi / 30.0, profile_.ticks_per_rev, kRest_s}),
      counts_(profile_) {}

void SpeedBase::event(const std::string& code, const std::string& text, bool stop) {
  motion_.event(code, text, stop, now_);
}

void SpeedBase::on_frame(const CanFrame& frame) {
  now_ = std::max(now_, frame.t);
  if (frame.error && (frame.id & 0x040u) != 0)
    return event("bus_off", "the CAN interface is off the bus; restart it", true);
  if (frame.error) return;
  protocol_->on_frame(frame);
  take_news();
}

void SpeedBase::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  now_ = std::max(now_, now);
  protocol_->on_bytes(bytes, now_);
  take_news();
}

void SpeedBase::take_news() {
  for (const DeviceMessage& message : protocol_->take_messages()) {
    if (is_command(message)) on_other_master();
    if (const auto voltage = voltage_in(message)) supply_voltage_ = voltage;
  }
  for (const SideCount& count : protocol_->take_counts()) on_count(count);
}

/// Our own frames do not come back (M19).
void SpeedBase::on_other_master() {
  ++other_master_;
  const bool first = now_ - last_other_master_ > motion::kOtherMasterAgain_s;
  last_other_master_ = now_;
  if (first || motion_.active())
    event("other_master", "another program commands this controller", motion_.active());
}

void SpeedBase::on_count(const SideCount& count) {
  counted_at_[index(count.side)] = now_;
  const WheelCounts::Reading reading = counts_.on_count(count.side, count.raw, count.t);
  if (reading.kind != TickUnwrap::Reading::Kind::wild)
    return motion_.counted(count.side, reading.forward, count.t, now_);
  motion_.moved(now_);
  event("tick_jump", std::string(to_text(count.side)) + " count jumped: reset, or a broken encoder line",
        motion_.motion() != Motion::off);
}

void SpeedBase::on_time(double now) {
  now_ = std::max(now_, now);
  check_presence();
  protocol_->ask(now_);
  if (!present_ && now_ >= greet_due_) {
    protocol_->greet(now_);
    greet_due_ = now_ + kGreet_s;
  }
  check_device();
  serve_reading();
  if (motion_.motion() == Motion::on) motion_.check_encoders(now_);
  motion_.cycle(now_);
}

void SpeedBase::check_presence() {
  const double oldest = std::min(counted_at_[0], counted_at_[1]);
  if (!present_) {
    present_ = now_ - oldest < profile_.counts_live_s;
    return;
  }
  if (now_ - oldest <= profile_.counts_live_s) return;
  event("counts_lost",
        "no counts of the controller for more than " +
            std::to_string(std::lround(1e3 * profile_.counts_live_s)) + " ms",
        true);
  present_ = false;
  motion_.forget();
  counts_.begin_segment();
}

void SpeedBase::check_device() {
  const DeviceState said = protocol_->device_state();
  if (!said.fault.empty() && said.fault != last_fault_) event("drive_fault", said.fault, true);
  last_fault_ = said.fault;
  if (motion_.motion() == Motion::on && said.enabled && !*said.enabled)
    event("axis_not_enabled", "the controller no longer follows commands", true);
}

void SpeedBase::enable(double now) {
  now_ = std::max(now_, now);
  motion_.enable(now_);
}

void SpeedBase::disable(double now) {
  now_ = std::max(now_, now);
  motion_.disable(now_);
}

void SpeedBase::quick_stop(double now) {
  now_ = std::max(now_, now);
  motion_.quick_stop(now_);
}

Result<void> SpeedBase::command(double left_rad_s, double right_rad_s, double now) {
  now_ = std::max(now_, now);
  return motion_.command(left_rad_s, right_rad_s, now_);
}

std::string SpeedBase::enable_refusal() const {
  if (!present_) return "the controller is not configured";
  if (!watchdog_armed()) return "the controller would not stop by itself if this program died";
  return last_fault_;
}

/// A device that says nothing follows as soon as it was asked to.
bool SpeedBase::follows() const { return asked_ && protocol_->device_state().enabled.value_or(true); }

std::string SpeedBase::enable_failure() const {
  return "the controller does not say that it follows commands: is a remote control or an "
         "emergency stop active?";
}

void SpeedBase::engage() {
  asked_ = true;
  protocol_->engage();
}

void SpeedBase::drive(double left_rad_s, double right_rad_s) {
  protocol_->command(profile_.left_sign * left_rad_s, profile_.right_sign * right_rad_s);
}

double SpeedBase::idle() { return kIdle_s; }

/// A time-out that the device itself states goes before the one that the profile promises.
double SpeedBase::watchdog_time() const {
  const double promised =
      profile_.watchdog.kind == ProfileWatchdog::Kind::builtin ? 1e-3 * profile_.watchdog.time_ms : 0.0;
  const double timeout = protocol_->reported_timeout_s().value_or(promised);
  const bool armed = present_ && timeout > 0.0 && timeout <= kLongestWatchdog_s;
  return armed ? timeout : 0.0;
}

ControllerState SpeedBase::state() const {
  if (!present_) return ControllerState::absent;
  if (motion_.enabling()) return ControllerState::enabling;
  if (motion_.motion() != Motion::off) return ControllerState::enabled;
  return last_fault_.empty() ? ControllerState::disabled : ControllerState::fault;
}

Error SpeedBase::refused(const std::string& what, const std::string& remedy) const {
  return {ErrorCode::refused, what, "controller " + profile_.name, remedy};
}

Result<void> SpeedBase::start_read_parameters(double now) {
  now_ = std::max(now_, now);
  if (!present_) return refused("controller does not answer", "wait until it does");
  job_result_.reset();
  if (protocol_->ask_settings()) {
    reading_ = Reading{now_ + kSettings_s, protocol_->settings_reported(), protocol_->reported_timeout_s()};
    return {};
  }
  job_result_ = ParameterJobResult{ParameterJobResult::Kind::read, std::nullopt, {}};
  return {};
}

/// Other settings it holds are not compared: counts do not depend on them.
std::optional<Error> SpeedBase::timeout_changed() const {
  const auto before = reading_->before, now = protocol_->reported_timeout_s();
  if (!before || !now || *before == *now) return std::nullopt;
  return refused("the controller reports a command time-out of " + std::to_string(std::lround(1e3 * *now)) +
                     " ms, not " + std::to_string(std::lround(1e3 * *before)) + " ms as before",
                 "it is taken over; see who changed it, then start again");
}

void SpeedBase::serve_reading() {
  if (!reading_) return;
  const bool reported = protocol_->settings_reported() > reading_->reports;
  if (!reported && present_ && now_ < reading_->ends_at) return;
  std::optional<Error> error = refused("the controller does not tell its settings", "look at its line");
  if (reported) error = timeout_changed();
  job_result_ = ParameterJobResult{ParameterJobResult::Kind::read, error, {}};
  reading_.reset();
}

Result<void> SpeedBase::start_write_parameters(const std::vector<ParameterValue>& /*values*/,
                                               double /*now*/) {
  return refused("the controller stores no wheel geometry", "the calibration is kept on the host");
}

Result<void> SpeedBase::start_store(double /*now*/) {
  return refused("the controller stores no wheel geometry", "the calibration is kept on the host");
}

std::vector<Capability> SpeedBase::capabilities() const { return host_capabilities(); }

Counters SpeedBase::counters() const {
  Counters all = protocol_->counters();
  all["other_master"] = other_master_;
  counts_.count_into(all);
  motion_.count_into(all);
  return all;
}

std::unique_ptr<Controller> make_speed_base(Profile profile, std::unique_ptr<SpeedProtocol> protocol) {
  return std::make_unique<SpeedBase>(std::move(profile), std::move(protocol));
}

}  // namespace odomcalib::drivers
