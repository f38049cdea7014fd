// The dialogue that starts a SCIP sensor: be quiet, who are you, what are your steps, laser on, measure.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/common/dialogue.hpp"
#include "drivers/lidar/scip/parameters.hpp"
#include "drivers/lidar/scip/reply.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers::scip {

class Startup {
 public:
  explicit Startup(bool intensities) : intensities_(intensities) {}

  void reset();
  /// @param heard whether bytes have come since the last call
  void step(double now, bool heard);
  void on_reply(const Reply& reply, double now);

  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }
  [[nodiscard]] const std::string& identity() const { return identity_; }
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }

 private:
  enum class Step { off, quiet, version, parameters, laser, measure, pause, measuring };
  void enter(Step step, double now);
  void gave_up(double now);
  void refused(const Reply& reply, const std::string& what, double now);
  void on_stream(const Reply& reply, double now);
  [[nodiscard]] std::string measure_command() const;

  bool intensities_;
  Step step_ = Step::off;
  Dialogue dialogue_;
  double since_ = 0.0, heard_at_ = 0.0;
  std::optional<Parameters> parameters_;
  std::string identity_;
  std::optional<Error> problem_;
};

}  // namespace odomcalib::drivers::scip
