// Scan pairs in, motions out: one JSON object a line. A line that cannot be used gets an answer of its own.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "calib/match.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"
#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

ordered_json refused(const std::string& status, const std::string& what) {
  return {{"status", status}, {"pose", nullptr}, {"covariance", nullptr},
          {"inliers", 0},     {"time_us", 0},    {"error", what}};
}

// The scan goes through the reader of recordings, so that both mean the same by every member.
Result<Scan> scan_of(const ordered_json& pair, const char* name) {
  if (!pair.contains(name) || !pair[name].is_object())
    return Error{ErrorCode::format, "no scan of this name", name, ""};
  ordered_json line = pair[name];
  line["type"] = "scan";
  if (!line.contains("t")) line["t"] = 0.0;
  RobotDescription any;  // the reader asks for one; nothing here depends on it
  any.left_wheel_diameter = any.right_wheel_diameter = any.track_width = any.ticks_per_rev = 1.0;
  auto recording = read_recording_bytes(line.dump() + "\n", name, &any);
  if (!recording) return recording.error();
  if (recording.value().scans.size() != 1)
    return Error{ErrorCode::format,
                 recording.value().discarded.empty() ? "no scan" : recording.value().discarded.front().reason,
                 name, ""};
  return std::move(recording.value().scans.front());
}

std::optional<std::array<double, 3>> guess_of(const ordered_json& pair) {
  std::array<double, 3> guess{};
  if (!pair.contains("guess")) return guess;
  const auto& given = pair["guess"];
  if (!given.is_array() || given.size() != 3) return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!given[i].is_number() || !std::isfinite(given[i].get<double>())) return std::nullopt;
    guess.at(i) = given[i].get<double>();
  }
  return guess;
}

/// Processor time of this thread: what other programs take of the processor is no cost of the match.
std::chrono::microseconds processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::seconds(now.tv_sec) +
                                                               std::chrono::nanoseconds(now.tv_nsec));
}

ordered_json describe(const calib::ScanMatch& match, std::chrono::microseconds time) {
  ordered_json body{{"status", match.status},
                    {"pose", nullptr},
                    {"covariance", nullptr},
                    {"inliers", match.inliers},
                    {"time_us", time.count()}};
  if (match.status == "degenerate") body["weak_direction"] = match.weak_direction;
  if (!match.ok()) return body;
  body["pose"] = match.pose;
  if (match.score)
    body["score"] = *match.score;
  else
    body["covariance"] = match.covariance;
  return body;
}

calib::Matcher matcher_of(const std::string& name) {
  if (name == "brute") return calib::Matcher::brute;
  return name == "fast" ? calib::Matcher::fast : calib::Matcher::lines;
}

ordered_json match_pair(const ordered_json& pair, calib::Matcher matcher) {
  if (!pair.is_object()) return refused("malformed", "the line is no JSON object");
  const auto reference = scan_of(pair, "reference");
  if (!reference) return refused("malformed", reference.error().text());
  const auto scan = scan_of(pair, "scan");
  if (!scan) return refused("malformed", scan.error().text());
  const auto guess = guess_of(pair);
  if (!guess) return refused("malformed", "guess is not three numbers");
  std::optional<double> sigma;
  if (pair.contains("sigma") && !pair["sigma"].is_null()) {
    sigma = pair["sigma"].is_number() ? pair["sigma"].get<double>() : -1.0;
    if (!(*sigma > 0.0 && *sigma < 10.0)) return refused("malformed", "sigma is not a length in m above 0");
  }
  const auto begin = processor_time();
  const auto match = matcher == calib::Matcher::lines
                         ? calib::match_scans(reference.value(), scan.value(), *guess, sigma)
                         : calib::search_scans(reference.value(), scan.value(), *guess, matcher);
  return describe(match, processor_time() - begin);
}

struct MatchOptions {
  std::string path, matcher = "lines";
  double unpack_limit = 0.0;  // MiB; 0: see UnpackLimit
};

int match_file(const MatchOptions& options, const Session& session) {
  const std::string& path = options.path;
  const UnpackLimit limit = unpack_limit_of(options.unpack_limit);
  const calib::Matcher matcher = matcher_of(options.matcher);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return report_error(bytes.error(), session.json);
  const Unpacked text =
      is_gzip(bytes.value()) ? gunzip(bytes.value(), limit) : Unpacked{bytes.value(), true, ""};
  if (text.over_limit) return report_error(limit.refusal(bytes.value().size(), path), session.json);
  if (!text.whole) warn(path + ": " + text.problem);
  if (is_recording(text.bytes))
    return report_error({ErrorCode::format, "is a recording, not pairs of scans", path,
                         "odomcalibctl solve matches its scans; --pairs writes the motions"},
                        session.json);
  std::istringstream file(text.bytes);
  std::size_t pairs = 0, read = 0;
  ProgressLine progress;
  for (std::string line; std::getline(file, line);) {
    // On a terminal the motions themselves show how far it is.
    if (isatty(STDOUT_FILENO) != 1)
      progress.show("matching", static_cast<double>(read) / static_cast<double>(text.bytes.size()));
    read += line.size() + 1;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ++pairs;
    std::cout << match_pair(ordered_json::parse(line, nullptr, false), matcher).dump() << '\n';
  }
  if (pairs == 0)
    return report_error({ErrorCode::empty, "no pair of scans", path, "one JSON object a line"}, session.json);
  return kDone;
}

}  // namespace

void add_match(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "match", "Motion between pairs of scans, JSON Lines in and out", match_file);
  verb->add_option("PAIRS", options->path,
                   R"(lines {"reference": scan, "scan": scan, "guess": [x,y,yaw], "sigma": m})")
      ->required();
  verb->add_option("--matcher", options->matcher,
                   "lines: point to line; brute: best of a grid; fast: hill climb")
      ->check(CLI::IsMember({"lines", "brute", "fast"}))
      ->capture_default_str();
  add_unpack_limit(*verb, options->unpack_limit);
}

}  // namespace odomcalib::cli
