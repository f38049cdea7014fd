// Process data of the one or two axes of a CANopen node: counts and status as they come, the cyclic command
// with its time-outs, SYNC.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/cia402/drive_state.hpp"
#include "drivers/base/cia402/pdo_dates.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/base/motion/motion_cycle.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

class ProcessData final : private MotionDevice {
 public:
  /// @param profile outlives this, as does @param out, where frames go in the order of their sending
  ProcessData(const Profile& profile, std::vector<CanFrame>& out);

  // From the node.
  /// @param expected the node was set up: its mapping is ours
  void on_frame(const canopen::Pdo& pdo, const CanFrame& frame, bool expected, double now);
  /// A SYNC was sent or seen: what is mapped to it was sampled then.
  void on_sync(double t) { dates_.on_sync(t); }

  // To the node; see MotionCycle.
  /// @param refusal why it must not get torque now, as far as the axes do not say it; empty: nothing is in
  /// the way
  void enable(const std::string& refusal, double now);
  void disable(double now);
  Result<void> command(double left_rad_s, double right_rad_s, double now);
  void quick_stop(double now);
  /// Sends what is due while the node is ready, and looks for process data that stay away.
  /// @param commanded somebody else has commanded the node: torque that we did not ask for may be his
  void cycle(bool commanded, double now);
  /// For drives that sample on SYNC, when it is due.
  void sync(double now);
  void event(const std::string& code, const std::string& text, bool stop, double now);

  /// The node was set up anew: its data are awaited.
  void expect();
  /// No motion is wanted, and nothing is sent.
  void begin_motion() { motion_.forget(); }
  /// The node is gone, or begins anew.
  void forget();

  [[nodiscard]] bool has_positions() const { return positions_at_.has_value(); }
  [[nodiscard]] bool has_status() const { return status_at_.has_value(); }
  [[nodiscard]] const MotionCycle& motion() const { return motion_; }
  [[nodiscard]] bool any_axis(canopen::DriveState state) const;
  std::vector<TickSample> take_ticks() { return counts_.take(); }
  std::vector<ControllerEvent> take_events() { return motion_.take_events(); }
  /// Frames that were understood.
  [[nodiscard]] std::uint64_t used() const { return used_; }
  /// Adds short_pdos, and what WheelCounts and MotionCycle count.
  void count_into(Counters& counters) const;

 private:
  void on_positions(std::int32_t left, std::int32_t right, double t);
  bool on_count(Side side, std::int32_t count, double t);
  void on_status(std::uint32_t status);
  void check_motion();
  [[nodiscard]] std::string enable_refusal() const override { return refusal_; }
  [[nodiscard]] bool follows() const override { return both_axes(canopen::DriveState::enabled); }
  [[nodiscard]] std::string enable_failure() const override;
  [[nodiscard]] bool shows_torque() const override { return any_axis(canopen::DriveState::enabled); }
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

  const Profile& profile_;
  std::vector<CanFrame>& out_;
  double now_ = 0.0;
  MotionCycle motion_;
  PdoDates dates_;
  WheelCounts counts_;
  std::string refusal_;     // of the last attempt to get torque
  bool commanded_ = false;  // by somebody else, see cycle()
  double sync_due_ = 0.0;
  std::optional<double> positions_at_;  // s, last position frame
  std::optional<double> status_at_;
  std::array<canopen::DriveState, 2> axes_{canopen::DriveState::not_ready, canopen::DriveState::not_ready};
  std::uint32_t fault_code_ = 0;
  unsigned cycles_ = 0;  // since torque is wanted
  std::uint64_t used_ = 0, short_pdos_ = 0;
};

}  // namespace odomcalib::drivers
