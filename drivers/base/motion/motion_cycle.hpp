// The motion of a controller, whatever it speaks: torque on, speed commands that grow old, stops, rest,
// counts that stand still. The device behind it says what it sees of its axes and sends what it is given.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/base/motion/stuck_watch.hpp"
#include "drivers/base/motion/wheel_counts.hpp"

namespace odomcalib::drivers {

/// Device functions that the motion needs. Speeds are wheel angular velocities in rad/s, forward positive.
class MotionDevice {
 public:
  MotionDevice() = default;
  MotionDevice(const MotionDevice&) = delete;
  MotionDevice& operator=(const MotionDevice&) = delete;
  virtual ~MotionDevice() = default;

  // The state of its axes, as it sees them.
  /// Why they must not get torque now; empty: nothing is in the way.
  [[nodiscard]] virtual std::string enable_refusal() const = 0;
  /// Both have torque and follow commands, as far as the device says.
  [[nodiscard]] virtual bool follows() const = 0;
  /// Error text when they do not follow within the time that is allowed.
  [[nodiscard]] virtual std::string enable_failure() const = 0;
  /// One has torque for sure. False of a device that does not say.
  [[nodiscard]] virtual bool shows_torque() const { return false; }
  /// None has torque, nor brakes electrically, for sure. False of a device that does not say.
  [[nodiscard]] virtual bool shows_no_torque() const { return false; }

  // Commands that it sends.
  /// A new attempt to get torque begins.
  virtual void begin_enabling() {}
  /// One step towards torque; repeated every cycle until the axes follow.
  virtual void engage() = 0;
  virtual void drive(double left_rad_s, double right_rad_s) = 0;
  /// The fastest stop the device offers; repeated every cycle until the wheels stand.
  virtual void stop() = 0;
  /// Takes the torque away.
  virtual void release() = 0;
  /// Called every cycle while no motion is wanted.
  /// @return s until the next call
  virtual double idle() = 0;
};

enum class Motion { off, enabling, on, disabling, stopping };

class MotionCycle {
 public:
  struct Options {
    std::string name;            ///< of the controller, for messages
    double max_rad_s = 0.0;      ///< of a wheel; faster commands are limited
    double ticks_per_rev = 0.0;  ///< of a wheel
    double rest_s = 0.0;         ///< counts that stood for so long are rest
  };
  /// @param device outlives this object and is not called before the first call here
  MotionCycle(MotionDevice& device, Options options);

  [[nodiscard]] Motion motion() const { return motion_; }
  /// On its way to torque, perhaps after the end of the motion before.
  [[nodiscard]] bool enabling() const { return motion_ == Motion::enabling || again_; }
  /// Torque is wanted.
  [[nodiscard]] bool active() const { return motion_ == Motion::on || enabling(); }
  [[nodiscard]] bool at_rest(double now) const { return now - moved_at_ >= options_.rest_s; }

  // Functions for Controller; `now` never goes back.
  /// While a motion ends: as soon as the axes are off.
  void enable(double now);
  void disable(double now);
  Result<void> command(double left_rad_s, double right_rad_s, double now);
  void quick_stop(double now);

  /// Keeps an event for take_events(). A stop event also stops the wheels right here: the daemon's protective
  /// stop is the second line, not the first.
  void event(const std::string& code, const std::string& text, bool stop, double now);
  std::vector<ControllerEvent> take_events() { return std::exchange(events_, {}); }

  /// A reading of one side's count.
  /// @param forward counts since the start, positive in the direction of positive commands
  /// @param t s, when the device took it
  void counted(Side side, std::int64_t forward, double t, double now);
  /// A count came that says nothing but that the wheel may have moved.
  void moved(double now) { moved_at_ = now; }
  /// Raises encoder_stuck when a count stands still although its wheel is commanded; to be called while on.
  void check_encoders(double now);
  /// The axes got a step further: what is waited for may take its whole time again.
  void progressed(double now) { since_ = now; }
  /// The device is gone, or new: no motion is wanted and nothing is sent.
  void forget() {
    motion_ = Motion::off;
    again_ = false;
  }

  /// To be called as time passes while the device is there; sends what is due.
  void cycle(double now);
  /// Something was sent between two cycles: the next one is due a whole period from now.
  void defer(double now);

  /// stale_commands, limited_commands and events_dropped.
  void count_into(Counters& counters) const;

 private:
  struct Wheel {
    explicit Wheel(double ticks_per_rev) : watch(ticks_per_rev) {}
    StuckWatch watch;
    std::optional<std::int64_t> forward;
  };

  void begin_enabling(double now);
  void step_enabling(double now);
  void step_on(double now);
  void step_ending(double now);
  void end(Motion how, double now);

  MotionDevice& device_;
  Options options_;
  std::array<Wheel, 2> wheels_;
  Motion motion_ = Motion::off;
  bool again_ = false;     // torque was asked for while a motion ended
  double since_ = 0.0;     // s, beginning of what is waited for
  double due_ = 0.0;       // s, next cycle
  double moved_at_ = 0.0;  // s, last change of either count
  std::array<double, 2> command_{};
  double command_at_ = -1e9;
  std::vector<ControllerEvent> events_;
  std::uint64_t stale_commands_ = 0, limited_commands_ = 0, dropped_ = 0;
};

}  // namespace odomcalib::drivers
