#include "proto/recording/recording.hpp"

namespace odomcalib {
namespace {

Error not_understood(const std::string& text) {
  return {
      ErrorCode::usage, "\"" + text + "\" is no choice of a topic", "--topic",
      "write PART=TOPIC or wheels=TOPIC:LEFT,RIGHT; parts are scan, wheels, wheel_speeds, odometry, gyro and "
      "pose"};
}

}  // namespace

Result<TopicChoice> parse_topic_choice(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos) return not_understood(text);
  TopicChoice choice;
  choice.part = text.substr(0, equals);
  const auto colon = text.find(':', equals);
  choice.topic = text.substr(equals + 1, colon == std::string::npos ? colon : colon - equals - 1);
  if (colon != std::string::npos) {
    const auto comma = text.find(',', colon);
    if (comma == std::string::npos) return not_understood(text);
    choice.joints = {text.substr(colon + 1, comma - colon - 1), text.substr(comma + 1)};
  }
  const bool joints = choice.part == "wheels" || choice.part == "wheel_speeds";
  const bool known = joints || choice.part == "scan" || choice.part == "odometry" || choice.part == "gyro" ||
                     choice.part == "pose";
  if (!known || choice.topic.empty() || (!joints && !choice.joints.empty())) return not_understood(text);
  return choice;
}

}  // namespace odomcalib
