#include "daemon/cli/inspection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/ingest/put_right.hpp"
#include "calib/ingest/recording_check.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/base_quantities.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib::cli {
namespace {

template <typename Samples>
void summarise(const char* name, const Samples& samples, std::vector<StreamSummary>& streams) {
  if (samples.empty()) return;
  StreamSummary stream{name, samples.size(), samples.front().t, samples.back().t, 0.0};
  for (std::size_t k = 1; k < samples.size(); ++k)
    stream.longest_gap = std::max(stream.longest_gap, samples[k].t - samples[k - 1].t);
  streams.push_back(std::move(stream));
}

std::vector<StreamSummary> streams_of(const Recording& recording) {
  std::vector<StreamSummary> streams;
  summarise(name_of(recording.motion), recording.ticks, streams);
  summarise("scan", recording.scans, streams);
  summarise("pose", recording.poses, streams);
  summarise("gyro", recording.gyro, streams);
  if (const auto& tuples = recording.increments; !tuples.empty()) {
    StreamSummary stream{"increment", tuples.size(), 0.0, 0.0, 0.0};
    for (const IncrementSample& one : tuples) stream.end += one.duration;
    streams.push_back(std::move(stream));
  }
  return streams;
}

double field_of_view(const Scan& scan) {
  if (scan.ranges.size() < 2) return 0.0;
  return std::abs(scan.angle(scan.ranges.size() - 1) - scan.angle(0));
}

std::optional<ScanSummary> scans_of(const std::vector<Scan>& scans) {
  if (scans.empty()) return std::nullopt;
  ScanSummary found{
      SIZE_MAX, 0, field_of_view(scans.front()), scans.front().range_min, scans.front().range_max, 0.0,
      false,    {}};
  std::size_t beams = 0, read = 0;
  for (const Scan& scan : scans) {
    found.fewest_beams = std::min(found.fewest_beams, scan.ranges.size());
    found.most_beams = std::max(found.most_beams, scan.ranges.size());
    beams += scan.ranges.size();
    read += scan.ranges.size() -
            static_cast<std::size_t>(std::count(scan.ranges.begin(), scan.ranges.end(), 0.0F));
    found.states_times = found.states_times || scan.time_increment || !scan.times.empty();
    if (!scan.sensor.empty()) ++found.sensors[scan.sensor];
  }
  found.share_read = beams > 0 ? static_cast<double>(read) / static_cast<double>(beams) : 0.0;
  return found;
}

bool has_lengths(const RobotDescription& robot) {
  return robot.left_wheel_diameter > 0.0 && robot.right_wheel_diameter > 0.0 && robot.track_width > 0.0;
}

std::optional<Motion> motion_of(const Recording& recording) {
  namespace wheels = calib::wheels;
  if (!has_lengths(recording.robot)) return std::nullopt;
  const wheels::WheelTrack track = recording.increments.empty()
                                       ? wheels::wheel_track_from_ticks(recording)
                                       : wheels::wheel_track_from_increments(recording);
  const auto kinds = calib::classical::motion_kinds(track, wheels::nominal_base(recording.robot));
  return Motion{kinds, calib::classical::parameter_supply(kinds)};
}

/// A nominal value that has to be stated somewhere.
struct NominalLength {
  const char* name;
  double RobotDescription::*value;
  double usual;
};

constexpr NominalLength nominal_length(BaseQuantity length, double usual) {
  return {name_of(length), member_of(length), usual};
}

constexpr std::array kNominals = {
    nominal_length(BaseQuantity::left_wheel_diameter, settings::kUsualDiameter_m),
    nominal_length(BaseQuantity::right_wheel_diameter, settings::kUsualDiameter_m),
    nominal_length(BaseQuantity::track_width, settings::kUsualTrack_m),
    NominalLength{"ticks_per_rev", &RobotDescription::ticks_per_rev, settings::kUsualTicks}};

RobotDescription filled_in(RobotDescription robot) {
  for (const auto& [name, value, usual] : kNominals)
    if (!(robot.*value > 0.0)) robot.*value = usual;
  return robot;
}

/// Names of what neither the recording nor the user stated.
std::vector<std::string> assumed_in(const Recording& recording, const RobotDescription& stated) {
  std::vector<std::string> names;
  for (const auto& [name, value, usual] : kNominals) {
    const bool needed = value != &RobotDescription::ticks_per_rev || recording.motion == MotionSource::ticks;
    if (needed && !(stated.*value > 0.0) && recording.robot.*value == usual) names.emplace_back(name);
  }
  return names;
}

/// The error that solve would find before it measures anything.
std::optional<Error> objection_to(const Recording& recording) {
  return calib::ingest::check_recordings(calib::ingest::put_right({&recording, 1}).view());
}

void look_at(Inspection& found) {
  const Recording& recording = *found.recording;
  found.streams = streams_of(recording);
  found.scans = scans_of(recording.scans);
  const auto& assumed = found.assumed;
  // Nobody can guess what a count is.
  if (std::find(assumed.begin(), assumed.end(), "ticks_per_rev") == assumed.end())
    found.motion = motion_of(recording);
  if (!found.error) found.error = objection_to(recording);
}

}  // namespace

double StreamSummary::rate() const {
  return end > begin ? static_cast<double>(samples - 1) / (end - begin) : 0.0;
}

Result<Inspection> inspect(const std::string& path, const RecordingOptions& options) {
  const auto topics = topic_choices_of(options);
  if (!topics) return topics.error();
  const auto robot = robot_of(options);
  if (!robot) return robot.error();
  const UnpackLimit limit = unpack_limit_of(options.unpack_limit);
  Inspection found;
  found.path = path;
  found.solve_arguments = shell_word(path) + to_arguments(options);
  auto recording = read_recording_with_overview(path, &robot.value(), topics.value(), limit, found.overview);
  if (!recording && recording.error().code == ErrorCode::io) return recording.error();
  if (!recording) found.error = recording.error();
  if (!recording && recording.error().code == ErrorCode::missing_units) {
    // Without lengths nothing can be told of the motion: usual ones tell at least its kinds.
    const RobotDescription usual = filled_in(robot.value());
    recording = read_recording_with_overview(path, &usual, topics.value(), limit, found.overview);
    if (recording) found.assumed = assumed_in(recording.value(), robot.value());
  }
  if (!recording && found.overview.topics.empty()) return recording.error();
  if (!recording) return found;
  found.recording = with_nominal(std::move(recording).value(), robot.value());
  look_at(found);
  return found;
}

}  // namespace odomcalib::cli
