// Where effects hook into the simulated robot. An effect overrides the stages it needs; it may keep state,
// and it sees the true motion. Stages run in the order of the declarations; several effects act one after the
// other.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tests/sim/world/geometry.hpp"

namespace odomcalib::sim {

/// Index of a side in the arrays below.
inline constexpr std::size_t kLeft = 0, kRight = 1;
using PerSide = std::array<double, 2>;

/// Data for an effect: the state at the beginning of a fine time step, and how the motors move in it.
struct StepView {
  double t = 0.0;          ///< s, true time
  double dt = 0.0;         ///< s
  Pose pose;               ///< base in the room
  PerSide angle{};         ///< rad, motor shaft referred to the wheel, since power-on
  PerSide rate{};          ///< rad/s
  PerSide acceleration{};  ///< rad/s^2
  PerSide turned{};        ///< rad, how far the shafts turn in this step
  double speed = 0.0;      ///< m/s, forward speed of the base in the previous step
  double yaw_rate = 0.0;   ///< rad/s, of the base in the previous step
};

/// How the base moves in this step; starts as ideal rolling of the true wheels.
struct StepMotion {
  PerSide travel{};          ///< m, of each contact point along the heading
  double track_width = 0.0;  ///< m, effective in this step
  double side = 0.0;         ///< m, to the left
  double yaw = 0.0;          ///< rad, added to what the wheels give
  Vec2 drift;                ///< m, in room axes
};

/// One sample of the counters on its way to the host.
struct TickReading {
  double t = 0.0;      ///< s, true time of sampling
  double stamp = 0.0;  ///< s, the time that the host will believe
  std::array<std::int64_t, 2> counts{};
  bool lost = false;  ///< set: the sample never arrives
};

/// One lidar beam. `angle` is the true direction in the lidar's frame (counter-clockwise positive).
struct BeamReading {
  double t = 0.0;           ///< s, true time
  double angle = 0.0;       ///< rad, true direction
  double range = 0.0;       ///< m, reported; 0 = no echo
  double true_range = 0.0;  ///< m; 0 = nothing there
  double incidence_cosine = 1.0;
};

/// One sweep on its way to the host.
struct ScanStamp {
  double t = 0.0;         ///< s, true time of the first beam
  double duration = 0.0;  ///< s
  double stamp = 0.0;     ///< s, the time that the host will believe
};

class Disturbance {
 public:
  Disturbance() = default;
  Disturbance(const Disturbance&) = delete;
  Disturbance& operator=(const Disturbance&) = delete;
  virtual ~Disturbance() = default;

  [[nodiscard]] virtual std::string name() const = 0;

  /// Distance that a wheel rolls in a whole turn, over that of the round wheel: what its diameter means then.
  [[nodiscard]] virtual double roundness(std::size_t /*side*/) const { return 1.0; }
  virtual void on_step(const StepView& /*view*/, StepMotion& /*motion*/) {}
  /// Angle that the encoder sees (rad per side); starts as the shaft angle at the end of the step.
  virtual void on_encoder(const StepView& /*view*/, PerSide& /*encoder_angle*/) {}
  /// On the wires a later stamp becomes a later arrival; an earlier one cannot be had there.
  virtual void on_ticks(TickReading& /*reading*/) {}
  /// Turns the direction in which a beam really leaves, before it is cast.
  virtual double beam_direction(double /*t*/, double angle) { return angle; }
  virtual void on_beam(BeamReading& /*beam*/) {}
  /// As for on_ticks: on the wires only later.
  virtual void on_scan(ScanStamp& /*scan*/) {}
};

}  // namespace odomcalib::sim
