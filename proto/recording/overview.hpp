// Properties of a file beside the recording itself: its form, and the topics of a ROS recording.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib {

struct TopicOverview {
  std::string name, type;
  std::string unread;         ///< why it cannot be read; empty: it can
  std::size_t messages = 0;   ///< in the file
  std::size_t malformed = 0;  ///< that do not hold what the type says
  std::optional<double> begin,
      end;                   ///< s since 1970, or of whatever clock stamped them; of those that were read
  double longest_gap = 0.0;  ///< s between two of them
  std::size_t without_stamp = 0;    ///< whose header has no time: that of reception counts
  std::vector<std::string> frames;  ///< "odom -> base_link" where a message names two
  std::vector<std::string> joints;
};

struct Overview {
  std::string form;                   ///< "JSON Lines", "MCAP", ...
  std::vector<TopicOverview> topics;  ///< of a ROS recording
};

/// As read_recording(), and what the file holds, as far as it was read before an error.
Result<Recording> read_recording_with_overview(const std::filesystem::path& path,
                                               const RobotDescription* fallback, const TopicChoices& topics,
                                               const UnpackLimit& limit, Overview& overview);

}  // namespace odomcalib
