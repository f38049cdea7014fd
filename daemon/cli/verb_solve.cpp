#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <set>

#include "calib/ingest/one_sensor.hpp"
#include "calib/solve.hpp"
#include "calib/terms/request.hpp"
#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/settings.hpp"
#include "odomcalib_version.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/file_bytes.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib::cli {
namespace {

struct SolveArguments {
  std::vector<std::string> recordings;
  std::vector<std::string> effects{"auto"};
  std::string scale, sensor, out, report, pairs, note, place;
  calib::classical::ClosedFormOptions cuts;
  RecordingOptions reading;
  bool same_robot = false, same_lidar = false;
  std::optional<double> odometer_km;
};

Result<void> write_results(const SolveArguments& options, const calib::Solution& solution) {
  const Calibration& calibration = solution.calibration;
  if (!options.pairs.empty())
    if (auto written = write_output(options.pairs, pairs_csv(solution.pairs, options.recordings)); !written)
      return written;
  if (!options.out.empty())
    if (auto written = write_output(options.out, to_json(calibration)); !written) return written;
  if (!options.report.empty()) return write_output(options.report, report_page(calibration));
  return {};
}

// Settings that a reader of the file must know to repeat the run.
SolveSettings settings_of(const SolveArguments& options) {
  SolveSettings settings;
  settings.version = kVersion;
  settings.effects = options.effects;
  settings.scale = options.scale;
  settings.sensor = options.sensor;
  const calib::classical::ClosedFormOptions usual;
  if (options.cuts.rounds != usual.rounds) settings.rounds = options.cuts.rounds;
  if (options.cuts.drop_fraction != usual.drop_fraction) settings.cut = options.cuts.drop_fraction;
  if (options.same_robot) settings.same_robot = true;
  if (options.same_lidar) settings.same_lidar = true;
  settings.place = options.place;
  settings.note = options.note;
  return settings;
}

Result<void> check_files(const SolveArguments& options) {
  auto inputs = named("a recording", options.recordings);
  inputs.push_back({"--robot", options.reading.robot_file});
  return check_outputs({{"--out", options.out}, {"--report", options.report}, {"--pairs", options.pairs}},
                       inputs);
}

std::optional<Error> wrong_sensor(const SolveArguments& options, const std::vector<Recording>& recordings) {
  if (options.sensor.empty()) return std::nullopt;
  std::set<std::string> sensors;
  for (const Recording& recording : recordings)
    for (const Scan& scan : recording.scans)
      if (!scan.sensor.empty()) sensors.insert(scan.sensor);
  if (sensors.contains(options.sensor)) return calib::ingest::lacks_sensor(recordings, options.sensor);
  return Error{ErrorCode::usage, "no scan is of the sensor \"" + options.sensor + "\"", "--sensor",
               sensors.empty() ? "leave it out: the scans name no sensor"
                               : fmt::format("there are: {}", fmt::join(sensors, ", "))};
}

/// Where the error does not say what to type, the content of the recording shows what is wrong with it.
int report_unreadable(const Error& error, const std::vector<std::string>& recordings, JsonMode json) {
  const int status = report_error(error, json);
  const bool said = error.remedy.find("odomcalibctl ") != std::string::npos;
  const bool of_recording = std::ranges::find(recordings, error.where) != recordings.end();
  if (!said && of_recording && error.code != ErrorCode::io)
    tell("what it holds: odomcalibctl inspect " + shell_word(error.where));
  return status;
}

int solve_recordings(const SolveArguments& options, const Session& session) {
  if (const auto wrong = calib::terms::wrong_effects(options.effects))
    return report_error(*wrong, session.json);
  if (const auto files = check_files(options); !files) return report_error(files.error(), session.json);
  calib::SolveOptions how{.effects = options.effects,
                          .same_robot = options.same_robot,
                          .same_lidar = options.same_lidar,
                          .cuts = options.cuts};
  if (!options.scale.empty()) {
    const auto scale = scale_from_text(options.scale);
    if (!scale) return report_error(scale.error(), session.json);
    how.scale = scale.value();
  }
  auto recordings = read_recordings(options.recordings, options.reading, Intensities::left_out);
  if (!recordings) return report_unreadable(recordings.error(), options.recordings, session.json);
  if (const auto wrong = wrong_sensor(options, recordings.value())) return report_error(*wrong, session.json);
  how.sensor = options.sensor;
  ProgressLine line;
  const auto progress = [&line](const std::string& phase, double fraction) { line.show(phase, fraction); };
  calib::Solution solution = calib::solve_with_pairs(recordings.value(), how, progress);
  Calibration& calibration = solution.calibration;
  calibration.settings = settings_of(options);
  if (options.odometer_km) calibration.odometer = 1000.0 * *options.odometer_km;
  line.clear();
  const auto written = write_results(options, solution);
  if (session.json == JsonMode::off)
    print_calibration(calibration, session);
  else
    print_json(to_json(calibration), session.json);
  // The minutes of a solve must not be lost with a file: the result was printed.
  if (!written) return report_error(written.error(), JsonMode::off);
  return calibration.verdict == Verdict::refused ? kRefused : kDone;
}

}  // namespace

void add_solve(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "solve", "Calibrate from recordings of one robot", solve_recordings);
  verb->add_option("RECORDING", options->recordings,
                   "JSON Lines, LCM log, ROS bag, rosbag2, MCAP, CARMEN log, tuple file")
      ->required();
  add_reading_options(*verb, options->reading);
  verb->add_option("--effects", options->effects, "auto, none, or names of effects to fit")->delimiter(',');
  verb->add_option("--scale", options->scale,
                   "metres in a metre of the reference, as a tape has it: 1.002+-0.001");
  verb->add_option("--sensor", options->sensor,
                   "of several lidars on one topic, the one whose scans are used; without: that with most");
  verb->add_flag("--same-robot", options->same_robot, "recordings with different robot_id are of one robot");
  verb->add_flag("--same-lidar", options->same_lidar,
                 "lidars whose names alone differ from recording to recording are one");
  add_output(*verb, "--out", options->out, "calibration file to write, also when refused");
  add_output(*verb, "--report", options->report, "HTML report to write");
  add_output(*verb, "--pairs", options->pairs,
             "CSV to write: each measured motion beside that of odometry, with its times");
  verb->add_option("--rounds", options->cuts.rounds, "of the closed form, that cut outliers (4)")
      ->check(whole(0, 100));
  verb->add_option("--cut", options->cuts.drop_fraction,
                   "share that each round of the closed form cuts (0.01)")
      ->check(finite(0.0, 0.5));
  verb->add_option("--odometer", options->odometer_km,
                   "km that the robot's counter of distance shows: kept in the file, compare draws over it")
      ->check(finite(0.0, settings::kMostOdometer_km));
  verb->add_option("--place", options->place, "where the robot drove: kept in file and report");
  verb->add_option("--note", options->note, "surface, load, tyres: kept in file and report");
  verb->parse_complete_callback([&session] { session.takes_much_memory = true; });
}

}  // namespace odomcalib::cli
