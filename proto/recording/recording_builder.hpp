// Collects what a reader finds in a file, checks it, and turns it into sorted streams. Internal to proto/.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/recording/recording.hpp"
#include "proto/recording/wheel_joining.hpp"

namespace odomcalib {

/// One reader fills one builder. Every rejected item is counted under (what, reason), with the times of the
/// first and the last.
class RecordingBuilder {
 public:
  explicit RecordingBuilder(Intensities intensities = Intensities::kept) : intensities_(intensities) {}
  /// The first description stays in force; a later, different one is counted as discarded.
  void add_robot(RobotDescription robot);
  void add_ticks(TickSample sample);
  void add_wheels(WheelSample sample);
  void add_wheel_speeds(WheelSample sample);
  /// One wheel without the other: angle in rad. Where no sample has both, finish() brings them to one
  /// instant.
  void add_wheel(Side side, SideSample sample);
  /// The same for a speed in rad/s.
  void add_wheel_speed(Side side, SideSample sample);
  void add_odometry(PoseSample sample);
  void add_scan(Scan scan);
  void add_pose(PoseSample sample);
  void add_gyro(GyroSample sample);
  void add_increment(IncrementSample sample);
  /// @param t s, of the sample, where it has a time that can be believed
  void discard(const std::string& what, const std::string& reason, std::size_t count = 1,
               std::optional<double> t = std::nullopt);
  /// Something was taken where the file held several.
  void choose(const std::string& choice) { recording_.choices.push_back(choice); }
  /// The order of the samples is not that in which a recorder had them: where stamps go back, no clock was
  /// set.
  void distrust_order() { is_in_order_ = false; }
  /// Messages of it were taken.
  void take_from(Middleware middleware) { recording_.middleware = middleware; }
  /// Times of what is added count from here.
  /// @param t s since 1970
  void count_from(double t) { recording_.time_zero = t; }
  /// Where the lidar sits, of a form that tells nothing else of the robot.
  void mount_lidar(const std::array<double, 3>& pose) { recording_.robot.lidar_pose = pose; }
  /// Whether anything tells the motion of the wheels.
  [[nodiscard]] bool has_motion() const;
  /// Why nothing does: what most samples of it were left out for.
  [[nodiscard]] Error no_motion(const std::string& where) const;
  /// The error, with what was noticed before it.
  [[nodiscard]] Error with_remarks(Error error) const;

  /// Whether a form carries the unit-bearing values; a form that needs none may leave them at zero.
  enum class RobotNeed { required, optional };

  /// Sorts, removes repeated time stamps, makes counts of the finest wheel motion that is there, unwraps
  /// counts, checks the robot description. Errors: empty, missing_units, format (stamps that are no seconds).
  Result<Recording> finish(const std::string& where, const RobotDescription* fallback, RobotNeed need) &&;

 private:
  /// Where one stream has come to, in file order.
  struct StreamClock {
    double newest;
    std::optional<double> before_leap;  ///< what `newest` was before the last sample leapt far ahead
    StreamClock();
  };

  /// Wheels that came one by one.
  struct Halves {
    std::array<std::vector<SideSample>, 2> samples;  // by Side
    [[nodiscard]] bool any() const { return !samples[0].empty() || !samples[1].empty(); }
  };

  [[nodiscard]] bool is_stamped(const char* what, double t);
  template <typename Sample>
  bool in_time(const char* what, const Sample& sample, StreamClock& clock, std::vector<Sample>& stream);
  template <typename Sample>
  void drop_late(const char* what, std::vector<Sample>& stream);
  void drop_late_scans();
  void drop_late_samples();
  enum class Device;
  template <typename Visit>
  void each_stream(Visit visit);
  void put_clocks_forward();
  template <typename Sample>
  void forget_leap(const char* what, StreamClock& clock, std::vector<Sample>& stream);
  void add_half(const char* what, Halves& halves, Side side, SideSample sample);
  [[nodiscard]] bool has_data() const;
  [[nodiscard]] Error nothing_usable(const std::string& where) const;
  template <typename Sample>
  void drop_second_writer(const char* what, std::vector<Sample>& stream);
  void drop_second_writers();
  void count_on();
  void join_halves(MotionSource source, Halves& halves, std::vector<WheelSample>& stream);
  Result<Recording> finished(const std::string& where, const RobotDescription* fallback, RobotNeed need);
  void merge_robot(const RobotDescription* fallback);
  /// How many there are of each kind, of which some were left out: before any stream is thinned.
  void count_streams();
  template <typename Sample, typename Same>
  void drop_repeated(const char* what, std::vector<Sample>& samples, Same same);
  void sort_streams();
  void decide_motion();
  void make_ticks();

  Recording recording_;
  Intensities intensities_;
  bool have_robot_ = false;
  bool is_in_order_ = true;
  std::map<std::pair<std::string, std::string>, Discarded> discarded_;  // by what and reason
  std::map<std::string, std::size_t> streams_;  // samples of each kind, with those left out
  std::size_t readings_ = 0;                    // of all scans
  Halves wheel_halves_, speed_halves_;
  std::string one_wheel_;  // which wheel alone the lines have; empty: they have both
};

/// Missing or impossible unit-bearing values of a robot description, or nullopt when it is complete.
std::optional<Error> check_robot(const RobotDescription& robot, const std::string& where);

}  // namespace odomcalib
