// The whole robot behind its wires: a CAN port with a CANopen drive and a serial port with an LD06.
//
// Time is virtual: step() advances it and exchanges bytes without blocking, so that a test interleaves it
// with the program under test faster than real time. Nothing here runs in a thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "proto/result.hpp"
#include "tests/sim/wires/can_port.hpp"
#include "tests/sim/wires/drive_node.hpp"
#include "tests/sim/wires/ld06_stream.hpp"
#include "tests/sim/wires/pty.hpp"
#include "tests/sim/world/body.hpp"
#include "tests/sim/world/rooms.hpp"

namespace odomcalib::sim {

struct SimRobotOptions {
  Geometry nominal;
  Geometry truth;  ///< e.g. draw_truth(nominal, seed)
  Room room = furnished_room();
  BodyOptions body;
  LidarOptions lidar;
  DriveNodeOptions node;  ///< `geometry_um` is filled in from `nominal`
  Disturbances disturbances;
  std::uint64_t seed = 1;
  std::filesystem::path link_dir;        ///< when set: stable links `can` and `lidar` in this folder
  std::optional<std::string> socketcan;  ///< interface instead of the slcan adapter
};

class SimRobot {
 public:
  /// Errors: io, when no pseudo-terminal, link or CAN socket can be made.
  static Result<std::unique_ptr<SimRobot>> create(const SimRobotOptions& options);

  /// Advances virtual time by dt seconds in fine steps and moves bytes both ways.
  void step(double dt);
  /// Runs `work` while the robot goes on in real time, for calls that wait for an answer (opening an slcan
  /// port). The robot must not be touched by `work`.
  void serve_during(const std::function<void()>& work);
  /// s since the start.
  [[nodiscard]] double now() const { return body_.time(); }

  /// Device strings and paths for the program under test. Paths are the links when there are any.
  [[nodiscard]] std::string can_device() const;
  [[nodiscard]] std::string lidar_device() const;
  [[nodiscard]] std::string can_path() const;
  [[nodiscard]] std::string lidar_path() const;

  // Truth
  [[nodiscard]] const Geometry& truth() const { return options_.truth; }
  [[nodiscard]] const Geometry& nominal() const { return options_.nominal; }
  [[nodiscard]] std::uint64_t seed() const { return options_.seed; }
  [[nodiscard]] const Body& body() const { return body_; }
  [[nodiscard]] const Pose& pose() const { return body_.pose(); }
  /// Wheel speeds in rad/s.
  [[nodiscard]] const PerSide& wheel_rate() const { return body_.rate(); }
  /// Rim speed of the faster wheel in m/s.
  [[nodiscard]] double fastest_rim() const;
  /// May be changed at any time, e.g. to put an obstacle in the way.
  Room& room() { return room_; }

  // Faults
  DriveNode& node() { return node_; }
  LidarFaults& lidar_faults() { return stream_.faults; }
  /// The bus wire behind the adapter is cut: the adapter itself still answers.
  void cut_can(bool cut) { can_cut_ = cut; }
  /// The adapter or the serial converter is pulled out: the port dies. Plugging in makes a new port (same
  /// link).
  void unplug_can() { can_.reset(); }
  Result<void> plug_can();
  void unplug_lidar() { lidar_pty_.reset(); }
  Result<void> plug_lidar();
  /// Power cycle of the drive alone, or of the lidar alone.
  void reset_drive() { node_.reset(now()); }
  void reset_lidar() { stream_.restart(now()); }
  void emergency(std::uint16_t code, std::uint8_t error_register = 0x01) {
    node_.emergency(code, error_register, now());
  }
  /// Added to the counters from now on, e.g. to bring them close to the 32-bit wrap, or as a jump.
  void shift_counts(std::int64_t left, std::int64_t right);
  /// A frame from somebody else on the bus: another master, a node with the same id.
  void inject(const Frame& frame);
  /// Raw bytes into the ports: noise, halves of lines, state lines of the adapter.
  void inject_can_bytes(const std::string& bytes);
  void inject_lidar_bytes(const std::string& bytes);
  /// The encoder of this side no longer moves (or moves again).
  void hold_encoder(std::size_t side, bool held);
  /// From now on counts of this side advance by `gain` times what they should: -1 inverted, 2 a wrong line
  /// count.
  void scale_encoder(std::size_t side, double gain);

 private:
  explicit SimRobot(const SimRobotOptions& options);

  void fine_step();
  void exchange_can();
  void move_body();
  [[nodiscard]] TickReading read_counters();
  [[nodiscard]] WheelState wheel_state();
  void queue_beams();

  SimRobotOptions options_;
  Room room_;
  Body body_;
  LidarHead head_;
  DriveNode node_;
  Ld06Stream stream_;
  std::unique_ptr<CanPort> can_;
  std::unique_ptr<Pty> lidar_pty_;
  std::vector<Beam> beams_;
  std::array<std::int64_t, 2> shift_{};
  std::array<double, 2> gain_{1.0, 1.0};
  std::array<std::optional<std::int64_t>, 2> held_;
  double wanted_ = 0.0;  ///< s, time that was asked for
  bool can_cut_ = false;
};

}  // namespace odomcalib::sim
