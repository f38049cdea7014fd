// Two CANopen drives with one axis each (docs/user/profiles.md, style "pair"): the left and the right wheel.
// Each is a DualAxis with one axis; together they are one controller.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/cia402/dual_axis.hpp"
#include "drivers/base/motion/tick_pairing.hpp"

namespace odomcalib::drivers {

class AxisPair final : public Controller {
 public:
  /// @param profile with two sides
  explicit AxisPair(const Profile& profile);

  void on_frame(const CanFrame& frame) override;
  void on_time(double now) override;
  std::vector<CanFrame> take_frames() override;
  std::vector<TickSample> take_ticks() override { return std::exchange(ticks_, {}); }
  std::vector<ControllerEvent> take_events() override { return std::exchange(events_, {}); }

  /// State of the drive that is further from moving.
  [[nodiscard]] ControllerState state() const override;
  void enable(double now) override;
  void disable(double now) override;
  Result<void> command(double left_rad_s, double right_rad_s, double now) override;
  void quick_stop(double now) override;
  [[nodiscard]] double watchdog_time() const override;
  [[nodiscard]] bool at_rest() const override { return drives_[0].at_rest() && drives_[1].at_rest(); }

  Result<void> start_read_parameters(double now) override;
  Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) override;
  Result<void> start_store(double now) override;
  std::optional<ParameterJobResult> take_job_result() override;
  [[nodiscard]] std::optional<double> touched() const override {
    return std::max(drives_[0].touched(), drives_[1].touched());
  }

  [[nodiscard]] std::optional<Identity> identity() const override;
  [[nodiscard]] std::vector<Identity> devices() const override;
  [[nodiscard]] RobotDescription description() const override { return robot_; }
  [[nodiscard]] std::vector<Capability> capabilities() const override;
  [[nodiscard]] Counters counters() const override;

 private:
  /// A job goes to one drive after the other; when the second fails, what the first one wrote is taken back.
  struct Job {
    explicit Job(ParameterJobResult::Kind what) : kind(what) {}
    ParameterJobResult::Kind kind;
    std::array<std::vector<ParameterValue>, 2> values;
    std::size_t side = 0;
    std::vector<StoredParameter> before, done;
    enum class Step { before, main, undo } step = Step::main;
    std::optional<Error> error;
  };

  void collect();
  void collect_events(std::size_t side);
  void collect_ticks(std::size_t side);
  void stop_the_other(std::size_t side);
  void send_sync();
  void advance_job();
  void start_side();
  void side_done(ParameterJobResult result);
  void finish_job(std::optional<Error> error);
  Result<void> begin(Job job);

  RobotDescription robot_;
  double sync_period_s_;
  std::uint8_t host_node_;
  std::array<DualAxis, 2> drives_;
  TickPairing pairing_;
  std::array<std::int32_t, 2> segments_{};
  double now_ = 0.0, sync_due_ = 0.0;
  std::optional<Job> job_;
  std::optional<ParameterJobResult> job_result_;
  std::vector<CanFrame> out_;
  std::vector<TickSample> ticks_;
  std::vector<ControllerEvent> events_;
};

}  // namespace odomcalib::drivers
