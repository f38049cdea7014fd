// Interface of every motor controller to the daemon. A controller is a pure state machine: frames or bytes
// and time in, frames or bytes and events out; it holds no file descriptor and no clock, so a test or a
// replay drives it directly.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/transport.hpp"
#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

enum class ControllerState {
  absent,       ///< nothing heard yet, or life signs lost
  configuring,  ///< identity check, heartbeat set-up, PDO mapping in progress
  disabled,     ///< configured, ticks arrive, axes without torque
  enabling,
  enabled,  ///< axes follow the commanded speed
  fault,
};

/// Something the daemon must know at once. `stop` events demand a protective stop.
struct ControllerEvent {
  double t = 0.0;
  std::string code;  ///< e.g. heartbeat_lost, emcy, unexpected_boot, identity_mismatch, sdo_abort
  std::string text;
  bool stop = false;
};

/// A quantity the controller stores: left_wheel_diameter, right_wheel_diameter, track_width (SI).
struct StoredParameter {
  std::string quantity;
  std::int64_t raw = 0;  ///< as on the wire
  double value = 0.0;    ///< raw * scale, the value in force
  double step = 0.0;     ///< quantisation in SI
};

struct ParameterValue {
  std::string quantity;
  double value = 0.0;
};

/// Outcome of an asynchronous parameter job, delivered once by take_job_result().
struct ParameterJobResult {
  enum class Kind { read, write, store } kind = Kind::read;
  std::optional<Error> error;               ///< empty: done
  std::vector<StoredParameter> parameters;  ///< read: what the controller holds; write: what was read back
};

/// Capability of the controller for one quantity of the robot's geometry. Quantities it cannot hold stay on
/// the host.
struct Capability {
  std::string quantity;
  bool readable = false, writable = false;
  bool stored = false;  ///< survives power-off
  std::string object;   ///< where it is held, in the controller's own terms; empty: nowhere
  double step = 0.0;    ///< SI, of one count; 0: not held
};
/// Capabilities of a controller that holds no geometry.
std::vector<Capability> host_capabilities();

enum class Wire { can, serial };

struct Identity {
  std::uint32_t vendor = 0, product = 0, revision = 0, serial = 0;
  std::string name;
};

class Controller {
 public:
  virtual ~Controller() = default;

  /// On CAN, frames go in and out; on a serial line, bytes.
  [[nodiscard]] virtual Wire wire() const { return Wire::can; }

  // Inputs
  /// The line was opened (again). @param baud of the serial line where the configuration states it
  virtual void on_connected(std::optional<unsigned> /*baud*/) {}
  virtual void on_frame(const CanFrame& /*frame*/) {}
  virtual void on_bytes(std::span<const std::uint8_t> /*bytes*/, double /*now*/) {}
  /// Call at least every 20 ms: sends heartbeats and speed commands, detects lost life signs and time-outs.
  virtual void on_time(double now) = 0;

  // Outputs since the last call
  virtual std::vector<CanFrame> take_frames() { return {}; }
  virtual std::vector<std::uint8_t> take_bytes() { return {}; }
  virtual std::vector<TickSample> take_ticks() = 0;
  virtual std::vector<ControllerEvent> take_events() = 0;

  // Motion. Speeds are wheel angular velocities in rad/s, forward positive on both sides.
  [[nodiscard]] virtual ControllerState state() const = 0;
  virtual void enable(double now) = 0;
  virtual void disable(double now) = 0;
  /// Refused (error refused) unless enabled and finite; a command older than 100 ms is replaced by zero.
  virtual Result<void> command(double left_rad_s, double right_rad_s, double now) = 0;
  /// Zero speed and quick stop at once, whatever the state; cannot fail and may be repeated.
  virtual void quick_stop(double now) = 0;
  /// True when the controller itself will stop the wheels if this program dies, set up and read back.
  [[nodiscard]] bool watchdog_armed() const { return watchdog_time() > 0.0; }
  /// s, how long it waits before that; 0: it does not.
  [[nodiscard]] virtual double watchdog_time() const = 0;

  /// The wheels have stood for at least 0.1 s: parameters may be written and stored.
  [[nodiscard]] virtual bool at_rest() const = 0;

  /// s, when somebody else was last seen to do something that may have changed the device, since it was last
  /// read; nullopt: nobody was. Not every bus shows what others send.
  [[nodiscard]] virtual std::optional<double> touched() const { return std::nullopt; }

  // Parameters: one job at a time, refused while the axes are not disabled; a write or a store, which may
  // change how far the robot goes, also unless at_rest(). A job that was started ends with a result, whatever
  // the device does: the driver bounds its time. What an earlier job left behind is not given for a later
  // one.
  /// Reads them, and, where the device lets it, whether the rest is as it was set up: its watchdog, its
  /// process data. A difference ends the job with an error that names the object, and the device is set up
  /// again.
  virtual Result<void> start_read_parameters(double now) = 0;
  virtual Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) = 0;
  virtual Result<void> start_store(double now) = 0;
  virtual std::optional<ParameterJobResult> take_job_result() = 0;

  [[nodiscard]] virtual std::optional<Identity> identity() const = 0;
  /// All devices that hold parameters: one, or the two drives of a pair. Empty until they are identified.
  [[nodiscard]] virtual std::vector<Identity> devices() const {
    const auto one = identity();
    return one ? std::vector<Identity>{*one} : std::vector<Identity>{};
  }
  /// V, of battery or supply, as the device said last; nullopt where it says nothing of it.
  [[nodiscard]] virtual std::optional<double> supply_voltage() const { return std::nullopt; }
  /// Nominal geometry from the profile: ticks per revolution, and the diameters and track where the profile
  /// states them.
  [[nodiscard]] virtual RobotDescription description() const = 0;
  [[nodiscard]] virtual std::vector<Capability> capabilities() const = 0;
  [[nodiscard]] virtual Counters counters() const = 0;
};

/// Reads a profile file (TOML) and makes the controller it describes.
/// Errors: io, format (says which key, what was found and what is allowed).
Result<std::unique_ptr<Controller>> make_controller(const std::string& profile_path);

}  // namespace odomcalib::drivers
