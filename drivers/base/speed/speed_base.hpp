// The controller (drivers/base/controller.hpp) around a SpeedProtocol: presence, commands that grow old,
// stops, rest, counts that stand still.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/base/motion/motion_cycle.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

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

}  // namespace odomcalib::drivers
