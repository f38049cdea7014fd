#include "calib/report/one_robot.hpp"

#include <cmath>
#include <utility>

#include "calib/math/number_text.hpp"
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

std::string amount_of_difference(const report::Homogeneity& found, Eigen::Index parameter,
                                 double difference) {
  if (parameter == vehicle::kMountYaw) return math::degrees_text(std::abs(difference));
  if (!is_length(parameter)) return math::millimetres_text(std::abs(difference));
  const double value = value_of(found, found.recording, parameter);
  return math::significant(100.0 * std::abs(difference / value), 3) + " % (" +
         math::millimetres_text(factor_of(parameter) * std::abs(difference)) + ")";
}

/// So large a difference is none that wider deviations could stand for.
bool is_too_far(const report::Homogeneity& found, std::size_t recording, Eigen::Index parameter) {
  const auto row = static_cast<Eigen::Index>(recording);
  if (!(std::abs(found.sigmas(row, parameter)) > settings::kPlainlyApart)) return false;
  const double difference = std::abs(found.differences(row, parameter));
  if (parameter == vehicle::kMountYaw) return difference > settings::kMountApart_rad;
  if (!is_length(parameter)) return difference > settings::kMountApart_m;
  return difference > settings::kLengthApart * std::abs(value_of(found, recording, parameter));
}

bool any_too_far(const report::Homogeneity& found) {
  for (std::size_t i = 0; i < found.own.size(); ++i)
    for (Eigen::Index k = 0; k < found.sigmas.cols(); ++k)
      if (is_too_far(found, i, k)) return true;
  return false;
}

}  // namespace

std::optional<Disagreement> recordings_apart(const report::Homogeneity& found,
                                             std::span<const Recording> recordings) {
  if (!(found.p_value < settings::kApartLevel)) return std::nullopt;
  const auto row = static_cast<Eigen::Index>(found.recording);
  const double difference = found.differences(row, found.parameter);
  const std::string what =
      "the recordings do not agree on one robot: in " + recordings[found.recording].name + " " +
      base_quantity_names()[static_cast<std::size_t>(found.parameter)] + " is " +
      amount_of_difference(found, found.parameter, difference) + (difference > 0.0 ? " larger" : " smaller") +
      " than in the " + (recordings.size() > 2 ? "others" : "other") + ", " +
      math::significant(std::abs(found.sigmas(row, found.parameter)), 3) + " deviations";
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
  calibration.homogeneity =
      HomogeneityTest{found.p_value,
                      {recordings[found.recording].name, names[static_cast<std::size_t>(found.parameter)],
                       found.sigmas(static_cast<Eigen::Index>(found.recording), found.parameter)}};
}

}  // namespace odomcalib::calib::report
