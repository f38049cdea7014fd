#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/predict.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/left_out_lines.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/discarded_json.hpp"
#include "proto/file_bytes.hpp"
#include "proto/recording/left_out.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib::cli {
namespace {

struct PredictOptions {
  std::string recording, calibration, trajectory;
  std::vector<double> noise;
  bool live = false;
  RecordingOptions reading;
};

struct Predicted {
  std::vector<PoseSample> poses;
  double track_width = 0.0;  ///< m
  std::vector<Discarded> discarded = {};
  std::vector<Repair> repairs = {};
};

Result<Calibration> chosen_calibration(const PredictOptions& options, const RobotDescription& robot) {
  if (options.calibration == "nominal") return calib::odometry::nominal_calibration(robot);
  auto calibration = read_finite_calibration(options.calibration);
  if (!calibration) return calibration;
  if (const auto needed = dimensions_of(calibration.value(), options.calibration); !needed)
    return needed.error();
  return calibration;
}

/// Lengths of another robot lead elsewhere, and nothing in the trajectory shows it.
Result<void> check_robot(const Calibration& calibration, const Recording& recording,
                         const PredictOptions& options) {
  const std::string &theirs = calibration.robot.robot_id, &ours = recording.robot.robot_id;
  if (options.calibration == "nominal" || theirs == ours) return {};
  if (!theirs.empty() && !ours.empty())
    return Error{ErrorCode::usage,
                 fmt::format(R"(is of robot "{}", but "{}" of "{}")", theirs, options.recording, ours),
                 options.calibration,
                 fmt::format("name a calibration of that robot; if only the name changed: --robot-id {}",
                             shell_word(theirs))};
  warn(fmt::format(R"({} is of robot "{}", but {} names none: whether they are of one robot cannot be told)",
                   ours.empty() ? options.calibration : options.recording, ours.empty() ? theirs : ours,
                   ours.empty() ? options.recording : options.calibration));
  return {};
}

// Facts that a reader of the trajectory must know, and would not see from it.
void warn_of(const Calibration& calibration, const std::string& where) {
  if (calibration.verdict == Verdict::refused && where != "nominal")
    warn(refusal_of(calibration, where).text() + "; its values are used all the same");
  for (const std::string& name : calib::odometry::unknown_effects(calibration))
    warn(fmt::format(R"({}: this program does not know the effect "{}"; odometry goes on without it)", where,
                     name));
}

// A calibration of lengths near zero, or counts without end, may still lead nowhere.
Result<std::vector<PoseSample>> finite_poses(std::vector<PoseSample> poses, const std::string& where) {
  const auto is_finite = [](const PoseSample& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.yaw);
  };
  if (std::all_of(poses.begin(), poses.end(), is_finite)) return poses;
  return Error{ErrorCode::format, "dead reckoning leads to no finite pose", where,
               "check the values of the calibration and the counts of the recording"};
}

// One line "t x y 0 0 0 qz qw" (TUM).
std::string to_tum(const std::vector<PoseSample>& poses) {
  std::string text;
  for (const PoseSample& pose : poses)
    fmt::format_to(std::back_inserter(text), "{:.6f} {:.9f} {:.9f} 0 0 0 {:.12f} {:.12f}\n", pose.t, pose.x,
                   pose.y, std::sin(0.5 * pose.yaw), std::cos(0.5 * pose.yaw));
  return text;
}

Result<Predicted> predicted(const PredictOptions& options) {
  const auto recordings = read_recordings({options.recording}, options.reading, Intensities::left_out);
  if (!recordings) return recordings.error();
  const Recording& recording = recordings.value().front();
  if (recording.ticks.empty())
    return Error{ErrorCode::empty, "no tick samples", options.recording,
                 "dead reckoning needs encoder counts, or wheel angles, speeds or odometry"};
  const auto calibration = chosen_calibration(options, recording.robot);
  if (!calibration) return calibration.error();
  if (const auto same = check_robot(calibration.value(), recording, options); !same) return same.error();
  warn_of(calibration.value(), options.calibration);
  warn_of_lost_motion(recording);
  auto path = options.live ? calib::odometry::predict_live(recording, calibration.value())
                           : calib::odometry::predict(recording, calibration.value());
  auto poses = finite_poses(std::move(path), options.recording);
  if (!poses) return poses.error();
  return Predicted{std::move(poses).value(),
                   calibration.value().parameter(BaseQuantity::track_width).value_or(0.0),
                   left_out_of(recording), recording.repairs};
}

/// Standard deviation of the last pose; nullopt where nobody stated the noise.
std::optional<std::array<double, 3>> deviation_of(const Predicted& found, const std::vector<double>& noise) {
  if (noise.empty()) return std::nullopt;
  return calib::odometry::deviation_at_end(found.poses, {noise.at(0), noise.at(1), noise.at(2)},
                                           found.track_width);
}

void print_end(const Predicted& found, const std::optional<std::array<double, 3>>& deviation,
               const Session& session) {
  const std::vector<PoseSample>& poses = found.poses;
  const PoseSample end = poses.empty() ? PoseSample{} : poses.back();
  if (session.json != JsonMode::off) {
    nlohmann::ordered_json body{{"poses", poses.size()}, {"end", {end.x, end.y, end.yaw}}};
    if (deviation) body["std"] = *deviation;
    body["discarded"] = to_json(found.discarded);
    body["repairs"] = to_json(found.repairs);
    return print_document("prediction", body, session.json);
  }
  print_line(fmt::format("{} poses, end x {:.4f} m, y {:.4f} m, yaw {:.5f} rad", poses.size(), end.x, end.y,
                         end.yaw));
  if (deviation)
    print_line(fmt::format("standard deviations there: x {:.4f} m, y {:.4f} m, yaw {:.5f} rad",
                           (*deviation)[0], (*deviation)[1], (*deviation)[2]));
}

int predict_trajectory(const PredictOptions& options, const Session& session) {
  const std::string calibration = options.calibration == "nominal" ? "" : options.calibration;
  if (const auto files =
          check_outputs({{"--trajectory", options.trajectory}}, {{"the recording", options.recording},
                                                                 {"--calibration", calibration},
                                                                 {"--robot", options.reading.robot_file}});
      !files)
    return report_error(files.error(), session.json);
  const auto found = predicted(options);
  if (!found) return report_error(found.error(), session.json);
  if (auto written = write_output(options.trajectory, to_tum(found.value().poses)); !written)
    return report_error(written.error(), session.json);
  print_end(found.value(), deviation_of(found.value(), options.noise), session);
  return kDone;
}

}  // namespace

void add_predict(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "predict", "Dead reckoning from the ticks of a recording", predict_trajectory);
  verb->add_option("RECORDING", options->recording, "in any form that solve reads")->required();
  verb->add_option("--calibration", options->calibration, "calibration file, or \"nominal\"")->required();
  add_output(*verb, "--trajectory", options->trajectory, "file to write, TUM format")->required();
  verb->add_flag("--live", options->live,
                 "each pose from the samples up to its own, as odomcalibd and libodomcalib have it");
  verb->add_option("--noise", options->noise,
                   "FORWARD,SIDEWAYS,YAW: deviations in m, m, rad of a metre rolled; tells those of the end")
      ->delimiter(',')
      ->expected(3)
      ->check(finite(0.0, 10.0));
  add_reading_options(*verb, options->reading);
}

}  // namespace odomcalib::cli
