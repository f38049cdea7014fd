// Two axes in one CANopen node (docs/user/profiles.md, style "dual-axis"), or one axis as a side of an
// AxisPair: the controller of drivers/base/controller.hpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/canopen/sdo_sequence.hpp"
#include "drivers/base/cia402/drive_state.hpp"
#include "drivers/base/cia402/parameter_job.hpp"
#include "drivers/base/cia402/pdo_dates.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/base/motion/motion_cycle.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

class DualAxis final : public Controller, private MotionDevice {
 public:
  explicit DualAxis(Profile profile);
  DualAxis(const DualAxis&) = delete;
  DualAxis& operator=(const DualAxis&) = delete;
  ~DualAxis() override = default;

  void on_frame(const CanFrame& frame) override;
  void on_time(double now) override;
  std::vector<CanFrame> take_frames() override;
  std::vector<TickSample> take_ticks() override { return counts_.take(); }
  std::vector<ControllerEvent> take_events() override { return motion_.take_events(); }

  [[nodiscard]] ControllerState state() const override;
  void enable(double now) override;
  void disable(double now) override;
  Result<void> command(double left_rad_s, double right_rad_s, double now) override;
  void quick_stop(double now) override;
  [[nodiscard]] double watchdog_time() const override {
    return watchdog_armed_ ? 1e-3 * profile_.watchdog.time_ms : 0.0;
  }
  [[nodiscard]] bool at_rest() const override { return motion_.at_rest(now_); }

  Result<void> start_read_parameters(double now) override;
  Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) override;
  Result<void> start_store(double now) override;
  std::optional<ParameterJobResult> take_job_result() override { return job_.take_result(); }
  [[nodiscard]] std::optional<double> touched() const override { return touched_at_; }

  [[nodiscard]] std::optional<Identity> identity() const override { return identity_; }
  [[nodiscard]] RobotDescription description() const override { return profile_.robot; }
  [[nodiscard]] std::vector<Capability> capabilities() const override;
  [[nodiscard]] Counters counters() const override;

  /// A SYNC was sent or seen: what is mapped to it was sampled then.
  void on_sync(double t) { dates_.on_sync(t); }
  /// Configured, or about to be started: process data are expected.
  [[nodiscard]] bool wants_sync() const { return phase_ == Phase::starting || phase_ == Phase::ready; }

 private:
  enum class Phase { absent, identifying, configuring, starting, ready, foreign };

  // dual_axis.cpp: events and life signs
  void event(const std::string& code, const std::string& text, bool stop);
  void on_error_frame(const CanFrame& frame);
  void on_emergency(const CanFrame& frame);
  void on_life_sign(const CanFrame& frame);
  void on_other_master(const CanFrame& frame);
  [[nodiscard]] bool commands_node(const CanFrame& frame) const;
  [[nodiscard]] bool receives(std::uint32_t cob_id) const;
  void advance_job();
  void check_life();
  void lose(const std::string& code, const std::string& text);
  void on_boot_up();
  void send_own_heartbeat();
  void send_nmt(std::uint8_t command);
  void send_sync();
  void restart_to_verify();
  void forget_node();

  // dual_axis_setup.cpp: identity, configuration, start
  void advance_setup();
  void look_for_node();
  void begin_identification();
  void end_identification();
  void begin_configuration();
  void end_configuration();
  void note_safety_objects();
  void note_as_set_up();
  void check_started();

  // dual_axis_motion.cpp: process data
  void on_process_data(const canopen::Pdo& pdo, const CanFrame& frame);
  void on_positions(std::int32_t left, std::int32_t right, double t);
  bool on_count(Side side, std::int32_t count, double t);
  void on_status(std::uint32_t status);
  void cycle_motion();
  void check_motion();
  [[nodiscard]] std::string enable_refusal() const override;
  [[nodiscard]] bool follows() const override;
  [[nodiscard]] std::string enable_failure() const override;
  [[nodiscard]] bool shows_torque() const override;
  [[nodiscard]] bool shows_no_torque() const override;
  void begin_enabling() override { cycles_ = 0; }
  void engage() override;
  void drive(double left_rad_s, double right_rad_s) override;
  void stop() override;
  void release() override;
  double idle() override;
  void send_command(std::uint16_t control_word, double left_rad_s, double right_rad_s);
  [[nodiscard]] std::int64_t speed_counts(double rad_s, int sign) const;
  [[nodiscard]] bool both_axes(canopen::DriveState state) const;
  [[nodiscard]] bool any_axis(canopen::DriveState state) const;
  [[nodiscard]] Result<void> job_allowed() const;
  Result<void> change_allowed(double now);

  const Profile profile_;
  double now_ = 0.0;
  canopen::SdoClient sdo_;
  canopen::SdoSequence setup_;
  ParameterJob job_;
  Phase phase_ = Phase::absent;
  double phase_since_ = 0.0;
  std::optional<double> look_after_;  // s, when to ask for the node (again)
  std::optional<Identity> identity_;
  bool watchdog_armed_ = false;
  std::vector<canopen::SdoOutcome> unlisted_;  // receive PDOs (1400h ff.) that the profile does not list
  std::vector<canopen::SdoStep> as_set_up_;    // checks of what was set up
  std::optional<double> touched_at_;           // s, when somebody else was last seen to change the node
  double read_since_ = 0.0;                    // s, begin of the reading in progress

  std::optional<double> heard_at_;  // s, last life sign
  bool fell_silent_ = false;        // was lost for want of life signs and has not booted since
  std::uint8_t node_state_ = 0;
  double own_heartbeat_due_ = 0.0;
  double sync_due_ = 0.0;
  double restarted_at_ = 0.0;  // when we reset the node to see what it stored
  double last_other_master_ = -1e9, last_foreign_data_ = -1e9;

  MotionCycle motion_;
  std::optional<double> positions_at_;  // s, last position frame
  std::optional<double> status_at_;
  std::uint32_t status_ = 0;
  std::array<canopen::DriveState, 2> axes_{canopen::DriveState::not_ready, canopen::DriveState::not_ready};
  std::uint32_t fault_code_ = 0;
  PdoDates dates_;
  WheelCounts counts_;
  unsigned cycles_ = 0;  // since torque is wanted

  std::vector<CanFrame> out_;
  std::uint64_t frames_in_ = 0, frames_used_ = 0, emergencies_ = 0, boot_ups_ = 0, heartbeats_ = 0,
                bad_frames_ = 0;
  std::uint64_t short_pdos_ = 0, other_master_ = 0, error_frames_ = 0;
  std::uint64_t foreign_commands_ = 0;  // of other_master_, those that may have changed what the node does
};

}  // namespace odomcalib::drivers
