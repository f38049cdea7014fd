#include "daemon/cli/left_out_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "daemon/cli/output.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/recording/left_out.hpp"

namespace odomcalib::cli {
namespace {

/// Begin of the recording it is from: with several, each reason begins with the name of its file.
std::optional<double> begin_of(const Calibration& calibration, const Discarded& one) {
  for (const DataUse& data : calibration.data)
    if (calibration.data.size() == 1 || one.reason.starts_with(data.name + ": ")) return data.begin;
  return std::nullopt;
}

/// Damage to a file counts however little it is: nobody knows how much that was.
bool is_worth_a_line(const Discarded& one) {
  return is_loss(one) && (one.of == 0 ? one.what == "file" || one.what == "chunk" || is_end_of_file(one)
                                      : share_of(one) >= settings::kTrace);
}

std::vector<std::string> lines_of(const std::vector<Discarded>& discarded, const auto& start) {
  std::vector<std::string> lines;
  lines.reserve(discarded.size());
  for (const Discarded& one : discarded) lines.push_back("not used: " + to_text(one, start(one)));
  return lines;
}

std::optional<double> begin_of(const Recording& recording) {
  return recording.ticks.empty() ? std::nullopt : std::optional(recording.ticks.front().t);
}

}  // namespace

std::vector<std::string> left_out_lines(const Calibration& calibration) {
  std::vector<const Discarded*> told;
  bool has_end = false;  // which is told once, whatever it broke
  for (const Discarded& one : calibration.discarded)
    if (is_worth_a_line(one) && !(has_end && is_end_of_file(one))) {
      told.push_back(&one);
      has_end = has_end || is_end_of_file(one);
    }
  std::stable_sort(told.begin(), told.end(),
                   [](const auto* a, const auto* b) { return share_of(*a) > share_of(*b); });
  std::vector<std::string> lines;
  for (const Discarded* one : told) {
    const std::string text = to_text(*one, begin_of(calibration, *one));
    const bool is_reason = std::any_of(calibration.reasons.begin(), calibration.reasons.end(),
                                       [&](const std::string& reason) { return reason.starts_with(text); });
    if (!is_reason && lines.size() < settings::kLeftOutLines) lines.push_back("Left out: " + text);
  }
  for (const Repair& one : calibration.repairs)
    if (lines.size() < 2 * settings::kLeftOutLines)
      lines.push_back(fmt::format("Put right: {}: {}; {}", one.what, one.chosen, one.reason));
  return lines;
}

std::vector<std::string> evidence_lines(const Calibration& calibration) {
  std::vector<std::string> lines =
      lines_of(calibration.discarded, [&](const Discarded& one) { return begin_of(calibration, one); });
  for (const Repair& one : calibration.repairs)
    lines.push_back(fmt::format("put right: {}: {}: {}", one.what, one.chosen, one.reason));
  return lines;
}

std::vector<std::string> evidence_lines(const Recording& recording) {
  return lines_of(left_out_of(recording), [&](const Discarded&) { return begin_of(recording); });
}

void warn_of_lost_motion(const Recording& recording) {
  for (const Discarded& one : left_out_of(recording))
    if (is_loss_of_motion(one))
      warn(to_text(one, begin_of(recording)) + "; the trajectory may be off from there on");
}

}  // namespace odomcalib::cli
