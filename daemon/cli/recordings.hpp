// Reading what the offline verbs name on their command line.
#pragma once

#include <string>
#include <vector>

#include "proto/recording/recording.hpp"
#include "proto/unpack_limit.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace odomcalib::cli {

struct RecordingOptions {
  std::string robot_file;     ///< TOML with nominal values that replace those of the recordings; empty: none
  std::string robot_id;       ///< instead of that of the recordings and of the file; empty: none
  double unpack_limit = 0.0;  ///< MiB that a packed file may unpack to; 0: see UnpackLimit
  std::vector<std::string> topics;  ///< PART=TOPIC[:LEFT,RIGHT]: what is what in ROS recordings
};

/// --unpack-limit, alike for every verb that reads packed files.
void add_unpack_limit(CLI::App& verb, double& limit);
UnpackLimit unpack_limit_of(double mebibytes);

/// --robot, --robot-id, --topic and --unpack-limit, alike for every verb that reads recordings.
void add_reading_options(CLI::App& verb, RecordingOptions& options);

/// These options as a shell takes them, each with a space before it.
std::string to_arguments(const RecordingOptions& options);

/// Topics chosen by --topic. Error: usage.
Result<TopicChoices> topic_choices_of(const RecordingOptions& options);

/// Nominal values of --robot and --robot-id; zero and empty where they say nothing. Errors of the file.
Result<RobotDescription> robot_of(const RecordingOptions& options);

/// With nominal values in place of its own, as far as they are stated.
Recording with_nominal(Recording recording, RobotDescription robot);

/// Where a file holds several of a kind, the one taken is named on standard error, a line each.
Result<std::vector<Recording>> read_recordings(const std::vector<std::string>& paths,
                                               const RecordingOptions& options, Intensities intensities);

}  // namespace odomcalib::cli
