// The dialogue that brings an RPLIDAR from any state to measuring: stop, who are you, are you well, which
// mode suits you, motor, scan.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/bytes.hpp"
#include "drivers/lidar/common/dialogue.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers::rplidar {

class Startup {
 public:
  enum class Mode {
    automatic,  ///< what the device calls its typical mode
    standard,   ///< the mode that every model has
    express     ///< the oldest compressed mode
  };
  explicit Startup(Mode mode) : mode_(mode) {}

  /// From the beginning. `Startup::step` does this by itself the first time.
  void reset();
  void step(double now);
  void on_answer(std::uint8_t type, Bytes payload, double now);
  /// The device announces measurements of this type, or sends some.
  void on_measurements(double now);

  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }
  /// True until the device has been asked who it is: whatever arrives is left over from before.
  [[nodiscard]] bool discarding() const { return step_ == Step::off || step_ == Step::stop; }
  /// As the device tells for its mode, s.
  [[nodiscard]] std::optional<double> sample_s() const { return sample_s_; }
  [[nodiscard]] std::optional<double> range_max_m() const { return range_max_m_; }
  [[nodiscard]] const std::string& identity() const { return identity_; }
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const;

 private:
  enum class Step {
    off,
    stop,
    info,
    health,
    restart,
    typical_mode,
    answer_type,
    sample,
    range,
    sample_legacy,
    motor_board,
    motor,
    scan,
    measuring
  };
  void enter(Step step, double now);
  void gave_up(double now);
  void on_info(Bytes payload, double now);
  void on_health(Bytes payload, double now);
  void on_configuration(Bytes payload, double now);
  void on_sample_time(Bytes payload, double now);
  [[nodiscard]] Step first_mode_step() const;
  [[nodiscard]] Step motor_step() const;
  [[nodiscard]] std::vector<std::uint8_t> motor_command(bool run) const;
  [[nodiscard]] std::vector<std::uint8_t> request_of(Step step) const;

  Mode mode_;
  Step step_ = Step::off;
  Dialogue dialogue_;
  unsigned model_ = 0, firmware_ = 0, scan_mode_ = 0;
  std::uint8_t packet_type_ = 0;
  bool was_reset_ = false;
  double silent_since_ = 0.0;
  std::optional<double> sample_s_, range_max_m_;
  std::string identity_;
  std::optional<Error> problem_;
};

}  // namespace odomcalib::drivers::rplidar
