#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "calib/odometry/predict.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/outputs.hpp"
#include "daemon/cli/recordings.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct Options {
  std::string recording, calibration, trajectory;
  RecordingOptions reading;
};

Result<Calibration> chosen_calibration(const Options& options, const RobotDescription& robot) {
  if (options.calibration == "nominal") return calib::odometry::nominal_calibration(robot);
  auto calibration = read_finite_calibration(options.calibration);
  if (!calibration) return calibration;
  if (const auto needed = dimensions_of(calibration.value(), options.calibration); !needed)
    return needed.error();
  return calibration;
}

// What a reader of the trajectory must know, and would not see from it.
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

Result<std::vector<PoseSample>> predicted(const Options& options) {
  const auto recordings = read_recordings({options.recording}, options.reading);
  if (!recordings) return recordings.error();
  const Recording& recording = recordings.value().front();
  if (recording.ticks.empty())
    return Error{ErrorCode::empty, "no tick samples", options.recording,
                 "dead reckoning needs encoder counts, or wheel angles, speeds or odometry"};
  const auto calibration = chosen_calibration(options, recording.robot);
  if (!calibration) return calibration.error();
  warn_of(calibration.value(), options.calibration);
  return finite_poses(calib::odometry::predict(recording, calibration.value()), options.recording);
}

int predict_trajectory(const Options& options, const Session& session) {
  const std::string calibration = options.calibration == "nominal" ? "" : options.calibration;
  if (const auto files =
          check_outputs({{"--trajectory", options.trajectory}}, {{"the recording", options.recording},
                                                                 {"--calibration", calibration},
                                                                 {"--robot", options.reading.robot_file}});
      !files)
    return report_error(files.error(), session.json);
  const auto poses = predicted(options);
  if (!poses) return report_error(poses.error(), session.json);
  if (auto written = write_output(options.trajectory, to_tum(poses.value())); !written)
    return report_error(written.error(), session.json);
  const PoseSample end = poses.value().empty() ? PoseSample{} : poses.value().back();
  if (session.json == JsonMode::off)
    std::cout << fmt::format("{} poses, end x {:.4f} m, y {:.4f} m, yaw {:.5f} rad\n", poses.value().size(),
                             end.x, end.y, end.yaw);
  else
    print_json(
        nlohmann::ordered_json{{"poses", poses.value().size()}, {"end", {end.x, end.y, end.yaw}}}.dump(),
        session.json);
  return kDone;
}

}  // namespace

void add_predict(CLI::App& app, Session& session) {
  auto* verb = app.add_subcommand("predict", "Dead reckoning from the ticks of a recording");
  auto options = std::make_shared<Options>();
  verb->add_option("RECORDING", options->recording)->required();
  verb->add_option("--calibration", options->calibration, "calibration file, or \"nominal\"")->required();
  verb->add_option("--trajectory", options->trajectory, "file to write, TUM format")->required();
  add_reading_options(*verb, options->reading);
  verb->callback([&session, options] {
    session.run = [&session, options] { return predict_trajectory(*options, session); };
  });
}

}  // namespace odomcalib::cli
