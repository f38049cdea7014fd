#include "calib/report/one_robot.hpp"

#include <cmath>
#include <utility>

#include "calib/math/number_text.hpp"
#include "calib/math/settings.hpp"
#include "calib/report/report.hpp"
#include "calib/report/settings.hpp"

namespace odomcalib::calib::report {
namespace {

bool is_length(Eigen::Index parameter) { return parameter < vehicle::kMountX; }

/// Diameters are stated, radii fitted.
double factor_of(Eigen::Index parameter) { return parameter < vehicle::kTrackWidth ? 2.0 : 1.0; }

double value_of(const report::Homogeneity& found, std::size_t recording, Eigen::Index parameter) {
  return found.own[recording] ? found.own[recording]->value(parameter) : 0.0;
}

std::string amount_of(const report::Homogeneity& found, const ParameterChange& change) {
  const double size = std::abs(change.difference);
  if (change.parameter == vehicle::kMountYaw) return math::degrees_text(size);
  if (!is_length(change.parameter)) return math::millimetres_text(size);
  const double value = value_of(found, found.odd->others.front(), change.parameter);
  return math::significant(100.0 * std::abs(size / value), 3) + " % (" +
         math::millimetres_text(factor_of(change.parameter) * size) + ")";
}

/// Such as "track_width is 1 % (4 mm) larger and lidar_x is 3 mm smaller".
std::string changes_text(const report::Homogeneity& found, const std::vector<ParameterChange>& changes) {
  std::string text;
  for (const ParameterChange& change : changes)
    text += (text.empty() ? "" : " and ") +
            base_quantity_names()[static_cast<std::size_t>(change.parameter)] + " is " +
            amount_of(found, change) + (change.difference > 0.0 ? " larger" : " smaller");
  return text;
}

std::string names_text(std::span<const Recording> recordings, const std::vector<std::size_t>& group) {
  std::string text;
  for (std::size_t k = 0; k < group.size(); ++k)
    text += (k == 0 ? "" : k + 1 < group.size() ? ", " : " and ") + recordings[group[k]].name;
  return text;
}

std::string deviations_of(const std::vector<ParameterChange>& changes) {
  return math::significant(std::abs(changes.front().sigmas), 3) + " deviations";
}

/// The recordings that differ, and in what. Two say nothing of which of them changed.
std::string what_differs(const report::Homogeneity& found, std::span<const Recording> recordings) {
  const OddRecordings& odd = *found.odd;
  const std::string of_odd = names_text(recordings, odd.odd), changes = changes_text(found, odd.changes),
                    deviations = ", " + deviations_of(odd.changes);
  std::string text = odd.is_decided
                         ? "in " + of_odd + " " + changes + " than in the others" + deviations
                         : changes + " in " + of_odd + " than in " + names_text(recordings, odd.others) +
                               deviations + "; which of them changed they do not tell";
  if (!odd.as_well.empty())
    text += "; it may as well be that " + changes_text(found, odd.as_well) + " there, " +
            deviations_of(odd.as_well);
  if (!odd.neither.empty())
    text += "; " + names_text(recordings, odd.neither) + (odd.neither.size() > 1 ? " agree" : " agrees") +
            " with neither";
  return text;
}

/// So large a difference is none that wider deviations could stand for.
bool is_too_far(const report::Homogeneity& found, const ParameterChange& change) {
  if (!(std::abs(change.sigmas) > math::settings::kClearSigmas)) return false;
  const double difference = std::abs(change.difference);
  if (change.parameter == vehicle::kMountYaw) return difference > settings::kMountApart_rad;
  if (!is_length(change.parameter)) return difference > settings::kMountApart_m;
  return difference >
         settings::kLengthApart * std::abs(value_of(found, found.odd->others.front(), change.parameter));
}

bool any_too_far(const report::Homogeneity& found) {
  for (const ParameterChange& change : found.odd->changes)
    if (is_too_far(found, change)) return true;
  for (Eigen::Index row = 0; row < found.sigmas.rows(); ++row)
    for (Eigen::Index k = 0; k < found.sigmas.cols(); ++k)
      if (is_too_far(found, {k, found.differences(row, k), found.sigmas(row, k)})) return true;
  return false;
}

}  // namespace

std::optional<Disagreement> recordings_apart(const report::Homogeneity& found,
                                             std::span<const Recording> recordings) {
  if (!found.odd || !(found.p_value < settings::kApartLevel)) return std::nullopt;
  const std::string what = "the recordings do not agree on one robot: " + what_differs(found, recordings);
  if (any_too_far(found))
    return Disagreement{true,
                        what +
                            "; solve recordings of different robots, or of one before and after a change of "
                            "tyres, load or lidar, separately"};
  return Disagreement{
      false, what +
                 "; the stated deviations are widened by what lies between recordings; if tyres, load "
                 "or floor changed, solve them separately"};
}

void store_homogeneity(const report::Homogeneity& found, std::span<const Recording> recordings,
                       Calibration& calibration) {
  const std::vector<std::string> names = base_quantity_names();
  calibration.recordings.clear();
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    RecordingAlone one{recordings[i].name, recordings[i].robot.robot_id, std::nullopt, std::nullopt, {}};
    if (found.own[i]) {
      auto& parameters = one.parameters.emplace();
      for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(names.size()); ++k) {
        const double variance = found.own[i]->covariance(k, k);
        if (!(variance > 0.0)) continue;
        const std::string& name = names[static_cast<std::size_t>(k)];
        parameters.emplace_back(
            name, EstimateAlone{factor_of(k) * found.own[i]->value(k), factor_of(k) * std::sqrt(variance)});
        one.deviation.emplace_back(name, found.sigmas(static_cast<Eigen::Index>(i), k));
      }
    }
    calibration.recordings.push_back(std::move(one));
  }
  const auto row = static_cast<Eigen::Index>(found.recording);
  calibration.homogeneity =
      HomogeneityTest{found.p_value,
                      {recordings[found.recording].name, names[static_cast<std::size_t>(found.parameter)],
                       found.odd ? found.odd->changes.front().sigmas : found.sigmas(row, found.parameter)}};
}

}  // namespace odomcalib::calib::report
