// A recording is the only input of calibration (formats: docs/user/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "proto/discarded.hpp"
#include "proto/measurements.hpp"
#include "proto/middleware.hpp"
#include "proto/result.hpp"
#include "proto/unpack_limit.hpp"

namespace odomcalib {

/// Reason of beams that are no distance this lidar can measure.
inline constexpr const char* kOutsideLimits = "outside range_min and range_max";

/// Reason of samples that carry the stamp of the one before.
inline constexpr const char* kRepeatedStamp = "repeated time stamp";

/// Reason of scans and poses that a driver sent again with a new stamp.
inline constexpr const char* kRepeatedValues = "same values as the one before, although the wheels turned";

/// Reason of counts that what moved there cannot be told from: a counter that wraps at another number, a
/// reset, a jump. Said of ticks, and left out is the way between two of them.
inline constexpr const char* kUncontinued =
    "count does not continue the one before: the way between is left out";

/// End of the reason of wheel motion that is there in a finer form, too.
inline constexpr const char* kFinerDecides = " are finer and decide";

/// End of the reason of what is not the robot's, among what is; and reason of scans that were not chosen.
inline constexpr const char* kOfSecondProgram = ", of a second program";
inline constexpr const char* kOfAnotherSensor = "of another sensor";

/// Reason of single counts that were taken for what lies between their neighbours.
inline constexpr const char* kMisread = "count read wrong once";

/// Ways in which a recording states the motion of the wheels, the finest first. One of them decides.
enum class MotionSource { ticks, wheels, wheel_speeds, odometry };

/// The name of its lines in JSON Lines, and of its part in TopicChoice.
const char* name_of(MotionSource source);

struct Recording {
  std::string name;  ///< file name without folder
  std::string
      sha256;  ///< of the file's bytes as stored (compressed files: of the compressed bytes), lower-case hex
  RobotDescription robot;
  // Each stream is sorted by time when reading is done.
  std::vector<TickSample> ticks;  ///< counted, or made of what `motion` names (ticks_per_rev is theirs then)
  std::vector<Scan> scans;
  std::vector<PoseSample> poses;
  std::vector<GyroSample> gyro;
  std::vector<IncrementSample> increments;  ///< tuple files only
  /// s since 1970 at which t is 0, where times count from a second of the file; 0: they are as recorded.
  double time_zero = 0.0;
  MotionSource motion = MotionSource::ticks;
  Middleware middleware = Middleware::none;
  // Sources of `ticks`, as recorded; empty but for the one that `motion` names.
  std::vector<WheelSample> wheels;        ///< rad
  std::vector<WheelSample> wheel_speeds;  ///< rad/s
  std::vector<PoseSample> odometry;       ///< computed by the robot with the nominal values
  std::vector<Discarded> discarded;
  std::vector<Repair> repairs;       ///< what was put right, or chosen for a reason
  std::vector<std::string> choices;  ///< what was taken where a file held several; nothing to choose: empty
};

/// Says which topic of a ROS recording is what, e.g. scan=/scan or
/// wheels=/joint_states:left_joint,right_joint.
struct TopicChoice {
  std::string part;                 ///< scan, wheels, wheel_speeds, odometry, gyro or pose
  std::string topic;                ///< as recorded
  std::vector<std::string> joints;  ///< left and right, of wheels and wheel_speeds; empty: by their names
  std::string right_topic = {};     ///< of the right wheel, where each wheel has a topic of its own
};
using TopicChoices = std::vector<TopicChoice>;

/// Reads "PART=TOPIC", "PART=TOPIC:LEFT,RIGHT" or, of wheels, "PART=LEFT_TOPIC,RIGHT_TOPIC". Error: usage.
Result<TopicChoice> parse_topic_choice(const std::string& text);

/// No calibration reads them; in an hour's recording they take as much memory as the ranges.
enum class Intensities { kept, left_out };

/// Reads a recording and recognises its form by content: JSON Lines (plain or gzip), native LCM log, LCM log
/// of the MBot/MaeBot family, ROS bag 2.0, rosbag2 (file or folder), MCAP, Censi's tuple file or raw JSON
/// log, CARMEN log. Errors: io (cannot open), empty (no usable line), missing_units (no or incomplete robot
/// line), format (unknown form; unpacks to more than the limit), usage (a topic has to be chosen, or the
/// chosen one is not there). A cut-off end is not an error: what is whole is used, `discarded` says what was
/// not.
/// @param fallback robot description for forms that carry none; its zero fields count as missing
/// @param topics what to take of a ROS recording; what is unique is taken without
Result<Recording> read_recording(const std::filesystem::path& path,
                                 const RobotDescription* fallback = nullptr, const TopicChoices& topics = {},
                                 const UnpackLimit& limit = {}, Intensities intensities = Intensities::kept);

/// Whether the content, plain or gzip, is a recording of one of the forms: for errors that say what a file
/// is.
bool is_recording(std::string_view bytes);

/// The same for content that is in memory already.
/// @param name file name, for messages and Recording::name
Result<Recording> read_recording_bytes(const std::string& bytes, const std::filesystem::path& name,
                                       const RobotDescription* fallback = nullptr,
                                       const TopicChoices& topics = {}, const UnpackLimit& limit = {});

/// Writes JSON Lines (gzip when the name ends in .gz), as write_output does. Counterpart of read_recording:
/// numbers survive unchanged, and wheel motion is written as it was recorded.
Result<void> write_recording_jsonl(const Recording& recording, const std::filesystem::path& path);

}  // namespace odomcalib
