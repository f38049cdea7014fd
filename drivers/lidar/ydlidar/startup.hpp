// The dialogue that starts a YDLIDAR that takes commands: stop, who are you, are you well, scan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/common/dialogue.hpp"
#include "drivers/lidar/ydlidar/packet.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers::ydlidar {

class Startup {
 public:
  void reset();
  void step(double now);
  void on_answer(const Answer& answer, double now);
  void on_measurements(double now);

  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }
  [[nodiscard]] static std::vector<std::uint8_t> stop_bytes();
  [[nodiscard]] const std::string& identity() const { return identity_; }
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }

 private:
  enum class Step { off, stop, info, health, scan, measuring };
  void enter(Step step, double now);
  void gave_up(double now);
  void on_info(Bytes payload, double now);
  void on_health(Bytes payload, double now);

  Step step_ = Step::off;
  Dialogue dialogue_;
  double silent_since_ = 0.0;
  std::string identity_;
  std::optional<Error> problem_;
};

}  // namespace odomcalib::drivers::ydlidar
