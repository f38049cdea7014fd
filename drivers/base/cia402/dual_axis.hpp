// Two axes in one CANopen node (docs/user/profiles.md, style "dual-axis"), or one axis as a side of an
// AxisPair: the controller of drivers/base/controller.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/cia402/node_setup.hpp"
#include "drivers/base/cia402/node_watch.hpp"
#include "drivers/base/cia402/parameter_job.hpp"
#include "drivers/base/cia402/process_data.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

/// Brings its parts together: what one finds changes what the others do.
class DualAxis final : public Controller {
 public:
  explicit DualAxis(Profile profile);
  DualAxis(const DualAxis&) = delete;
  DualAxis& operator=(const DualAxis&) = delete;
  ~DualAxis() override = default;

  void on_frame(const CanFrame& frame) override;
  void on_time(double now) override;
  std::vector<CanFrame> take_frames() override;
  std::vector<TickSample> take_ticks() override { return data_.take_ticks(); }
  std::vector<ControllerEvent> take_events() override { return data_.take_events(); }

  [[nodiscard]] ControllerState state() const override;
  void enable(double now) override;
  void disable(double now) override;
  Result<void> command(double left_rad_s, double right_rad_s, double now) override;
  void quick_stop(double now) override;
  [[nodiscard]] double watchdog_time() const override {
    return setup_.watchdog_armed() ? 1e-3 * profile_.watchdog.time_ms : 0.0;
  }
  [[nodiscard]] bool at_rest() const override { return data_.motion().at_rest(now_); }

  Result<void> start_read_parameters(double now) override;
  Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) override;
  Result<void> start_store(double now) override;
  std::optional<ParameterJobResult> take_job_result() override { return job_.take_result(); }
  [[nodiscard]] std::optional<double> touched() const override { return watch_.touched(); }

  [[nodiscard]] std::optional<Identity> identity() const override { return setup_.identity(); }
  [[nodiscard]] RobotDescription description() const override { return profile_.robot; }
  [[nodiscard]] std::vector<Capability> capabilities() const override;
  [[nodiscard]] Counters counters() const override;

  /// See ProcessData::on_sync().
  void on_sync(double t) { data_.on_sync(t); }
  /// Process data are expected.
  [[nodiscard]] bool wants_sync() const { return setup_.started(); }

 private:
  using Phase = NodeSetup::Phase;

  void event(const ControllerEvent& found);
  void on_other_master(const CanFrame& frame);
  void take(const NodeWatch::Finding& finding);
  void lose(const ControllerEvent& why);
  void forget_node(double pause);
  void restart_to_verify();
  void advance_setup();
  void advance_job();
  void send_own_heartbeat();
  void send_sync();
  [[nodiscard]] NodeWatch::Situation situation() const;
  [[nodiscard]] std::string enable_refusal() const;
  [[nodiscard]] Result<void> job_allowed() const;
  Result<void> change_allowed(double now);

  const Profile profile_;
  double now_ = 0.0;
  std::vector<CanFrame> out_;
  canopen::SdoClient sdo_;
  NodeSetup setup_;
  NodeWatch watch_;
  ProcessData data_;
  ParameterJob job_;
  double read_since_ = 0.0;    // s, begin of the reading in progress
  double started_at_ = -1e9;   // s, when the node was last started
  double restarted_at_ = 0.0;  // s, when we reset the node to see what it stored
  std::uint64_t frames_in_ = 0, answers_ = 0;
};

}  // namespace odomcalib::drivers
