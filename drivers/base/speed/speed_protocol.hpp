// The bytes of a controller that takes wheel speeds and gives counts. Every such device is one class of this
// shape in a folder of its own; what the devices have in common (time-outs, life signs, stopping) is
// SpeedBase.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base/controller.hpp"
#include "drivers/base/motion/settings.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/wire_table.hpp"

namespace odomcalib::drivers {

struct SideCount {
  double t = 0.0;
  Side side = Side::left;
  std::int64_t raw = 0;  ///< as the device counts: unsigned, wrapping, mirrored
};

/// State that a device reports; the rest stays empty.
struct DeviceState {
  std::optional<bool> enabled;  ///< follows speed commands
  std::string fault;            ///< empty: none
};

class SpeedProtocol {
 public:
  virtual ~SpeedProtocol() = default;
  [[nodiscard]] virtual Wire wire() const = 0;

  // From the device.
  virtual void on_frame(const CanFrame& /*frame*/) {}
  virtual void on_bytes(std::span<const std::uint8_t> /*bytes*/, double /*now*/) {}
  /// The line is new: nothing received before belongs to what comes now.
  virtual void on_connected(std::optional<unsigned> /*baud*/) {}

  // To the device.
  /// Who are you, and start talking; called every 0.3 s until counts arrive.
  virtual void greet(double now) = 0;
  /// Called every few ms: questions to devices that speak only when asked, keep-alives.
  virtual void ask(double /*now*/) {}
  virtual void engage() {}
  virtual void command(double left_rad_s, double right_rad_s) = 0;
  /// The fastest stop the device offers; repeated until the wheels stand.
  virtual void stop() { command(0.0, 0.0); }
  virtual void release() {}

  [[nodiscard]] virtual std::optional<Identity> identity() const { return std::nullopt; }
  [[nodiscard]] virtual DeviceState device_state() const { return {}; }
  /// The device was asked for its command time-out: what it answered, in s.
  [[nodiscard]] virtual std::optional<double> reported_timeout_s() const { return std::nullopt; }
  /// Asks the device for its own settings, that time-out among them. @return false: it does not tell them
  virtual bool ask_settings() { return false; }
  /// How often it has reported them.
  [[nodiscard]] virtual std::uint64_t settings_reported() const { return 0; }
  [[nodiscard]] virtual Counters counters() const = 0;

  std::vector<CanFrame> take_frames() { return std::exchange(frames_, {}); }
  std::vector<std::uint8_t> take_bytes() { return std::exchange(bytes_, {}); }
  std::vector<SideCount> take_counts() { return std::exchange(counts_, {}); }
  std::vector<DeviceMessage> take_messages() { return std::exchange(messages_, {}); }

 protected:
  static constexpr std::size_t kMostQueued = motion::kMostQueued;  // of each kind

  void send(const CanFrame& frame) {
    if (frames_.size() < kMostQueued) frames_.push_back(frame);
  }
  void send(std::span<const std::uint8_t> bytes) {
    if (bytes_.size() < kMostQueued) bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void count(Side side, double t, std::int64_t raw) {
    if (counts_.size() < kMostQueued) counts_.push_back({t, side, raw});
  }
  void report(DeviceMessage message) {
    if (messages_.size() < kMostQueued) messages_.push_back(std::move(message));
  }

 private:
  std::vector<CanFrame> frames_;
  std::vector<std::uint8_t> bytes_;
  std::vector<SideCount> counts_;
  std::vector<DeviceMessage> messages_;
};

/// For devices that take the robot's speed and turn rate instead of wheel speeds.
struct Twist {
  double speed = 0.0;      ///< m/s
  double turn_rate = 0.0;  ///< rad/s, counter-clockwise positive
};

/// With the nominal geometry: the device turns it back into wheel speeds with its own.
inline Twist twist_of(const RobotDescription& robot, double left_rad_s, double right_rad_s) {
  const double left = 0.5 * robot.left_wheel_diameter * left_rad_s;
  const double right = 0.5 * robot.right_wheel_diameter * right_rad_s;
  return {0.5 * (left + right), robot.track_width > 0.0 ? (right - left) / robot.track_width : 0.0};
}

/// The protocol that the profile names. Error usage: no such protocol.
Result<std::unique_ptr<SpeedProtocol>> make_speed_protocol(const Profile& profile);

}  // namespace odomcalib::drivers
