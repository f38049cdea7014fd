#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/left_out_lines.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"
#include "proto/calibration/discarded_json.hpp"
#include "proto/file_bytes.hpp"
#include "proto/recording/left_out.hpp"

namespace odomcalib::cli {
namespace {

struct ConvertOptions {
  std::string recording, out;
  RecordingOptions reading;
};

nlohmann::ordered_json summary_of(const Recording& recording) {
  return {{"motion", name_of(recording.motion)},  {"samples", recording.ticks.size()},
          {"scans", recording.scans.size()},      {"poses", recording.poses.size()},
          {"gyro", recording.gyro.size()},        {"discarded", to_json(left_out_of(recording))},
          {"repairs", to_json(recording.repairs)}};
}

void print_summary(const Recording& recording, const std::string& out) {
  print_line(fmt::format("{}: {} {}, {} scans, {} poses, {} gyro readings", out, recording.ticks.size(),
                         name_of(recording.motion), recording.scans.size(), recording.poses.size(),
                         recording.gyro.size()));
  for (const std::string& line : evidence_lines(recording)) print_line("  " + line);
}

/// Whoever asks for a bag would find JSON in it.
std::optional<Error> other_form(const std::string& out) {
  for (const char* suffix : {".bag", ".db3", ".mcap", ".lcm", ".log", ".csv", ".g2o"})
    if (out.ends_with(suffix))
      return Error{ErrorCode::usage, "convert writes JSON Lines only", out,
                   "name the file .jsonl, or .jsonl.gz to pack it"};
  return std::nullopt;
}

int convert_recording(const ConvertOptions& options, const Session& session) {
  if (const auto error = other_form(options.out)) return report_error(*error, session.json);
  if (const auto files = check_outputs({{"--out", options.out}}, {{"the recording", options.recording},
                                                                  {"--robot", options.reading.robot_file}});
      !files)
    return report_error(files.error(), session.json);
  const auto recordings = read_recordings({options.recording}, options.reading, Intensities::kept);
  if (!recordings) return report_error(recordings.error(), session.json);
  const Recording& recording = recordings.value().front();
  if (!recording.increments.empty())
    return report_error({ErrorCode::format, "holds means over intervals, not samples", options.recording,
                         "solve reads it as it is"},
                        session.json);
  const auto written = [&] {
    const Meanwhile shown("writing " + options.out);
    return write_recording_jsonl(recording, options.out);
  }();
  if (!written) return report_error(written.error(), session.json);
  if (session.json == JsonMode::off)
    print_summary(recording, options.out);
  else
    print_document("conversion", summary_of(recording), session.json);
  return kDone;
}

}  // namespace

void add_convert(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "convert", "Write any recording as JSON Lines", convert_recording);
  verb->add_option("RECORDING", options->recording, "in any form that solve reads")->required();
  add_output(*verb, "--out", options->out, "file to write: .jsonl, or .jsonl.gz to pack it")->required();
  add_reading_options(*verb, options->reading);
}

}  // namespace odomcalib::cli
