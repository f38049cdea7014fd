// The dialogue that starts a SICK sensor: which dialect do you speak, who are you, are you ready, send scans.
// It changes no setting and needs no log-in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/cola/telegram.hpp"
#include "drivers/lidar/common/dialogue.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers::cola {

class Startup {
 public:
  void reset();
  void step(double now);
  void on_telegram(const Telegram& telegram, double now);

  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const;
  [[nodiscard]] const std::string& identity() const { return identity_; }
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }

 private:
  enum class Step { off, identify, state, pause, subscribe, measuring };
  void enter(Step step, double now);
  void gave_up(double now);
  void on_refusal(const Telegram& telegram, double now);
  void on_state(const Telegram& telegram, double now);

  Step step_ = Step::off;
  Dialect dialect_ = Dialect::binary;
  Dialogue dialogue_;
  double since_ = 0.0;
  std::string identity_;
  std::optional<Error> problem_;
};

}  // namespace odomcalib::drivers::cola
