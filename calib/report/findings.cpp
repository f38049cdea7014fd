#include "calib/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/classical/motion_kinds.hpp"
#include "calib/estimation/gyro_fit.hpp"
#include "calib/matching/point_to_line.hpp"
#include "calib/report/contact_noise.hpp"
#include "calib/report/found_effects.hpp"
#include "calib/report/gate.hpp"
#include "calib/report/left_out.hpp"
#include "calib/report/one_robot.hpp"
#include "calib/report/outlier_trace.hpp"
#include "calib/report/report.hpp"
#include "calib/report/report_data.hpp"
#include "calib/report/settings.hpp"
#include "calib/report/verdict_rules.hpp"
#include "calib/selection/file_entries.hpp"
#include "calib/selection/lidar_trace.hpp"
#include "calib/validation/held_out.hpp"

namespace odomcalib::calib::report {
namespace {

/// An entry for each recording whose gyro was weighed.
/// @param recordings one for each of the gyros
std::vector<GyroResult> entries_of(const estimation::GyroFit& witness,
                                   std::span<const Recording> recordings) {
  std::vector<GyroResult> entries;
  for (std::size_t k = 0; k < witness.gyros.size(); ++k) {
    const estimation::GyroFinding& gyro = witness.gyros[k];
    if (gyro.used > 0)
      entries.push_back(
          {recordings[k].name, gyro.used, gyro.scale, gyro.scale_std, gyro.bias, gyro.offset, gyro.fault});
  }
  return entries;
}

/// A sentence for each gyro that was left out.
std::vector<std::string> remarks_on(const estimation::GyroFit& witness,
                                    std::span<const Recording> recordings) {
  std::vector<std::string> remarks;
  for (std::size_t k = 0; k < witness.gyros.size(); ++k)
    if (const auto& fault = witness.gyros[k].fault)
      remarks.push_back(recordings.size() > 1 ? recordings[k].name + ": " + *fault : *fault);
  return remarks;
}

using SmoothTerms = std::vector<terms::FittedSmoothTerm>;
using Outliers = std::optional<report::OutlierTrace>;
using PlainFit = std::optional<estimation::FitResult>;

/// Base parameters: values, and how well they are known.
struct BaseEstimate {
  QuantityList measured;       ///< with the deviations that the motion leaves
  QuantityList stated;         ///< also with what nobody knows of the functions of the effects
  Eigen::MatrixXd covariance;  ///< of what is stated, in radii
};

/// Matches of keyframes are not free of bias; neither is a model with a term that was found to fit, whose
/// true shape nobody knows (a delay may be a filter). Places in a map are, as far as simulated drives show.
double scale_deviation(const Findings& found) {
  const measurement::Dataset& dataset = found.fit.dataset;
  if (!dataset.reference_is_scans()) return 0.0;
  if (found.every_scan_placed && found.outcome.model.effects.empty() && found.lidar.empty()) return 0.0;
  return std::hypot(settings::kMatcherScale,
                    selection::range_scale_uncertainty(found.lidar, dataset.recordings.view()));
}

/// With what was found in all recordings, what each of them says alone.
struct Agreement {
  std::optional<report::Homogeneity> homogeneity;
  std::optional<Disagreement> apart;  ///< what speaks against one set of lengths
};

Agreement agreement(const Findings& found) {
  const measurement::Dataset& dataset = found.fit.dataset;
  if (dataset.recordings.size() < 2) return {};
  std::vector<std::string> names;
  for (const Recording& recording : dataset.recordings.view()) names.push_back(recording.name);
  const double metre = dataset.reference_is_scans() ? settings::kMatcherScale : 0.0;
  auto homogeneity = report::homogeneity({dataset.data, dataset.fixed()}, found.outcome.model, metre, names);
  if (!homogeneity) return {};
  auto apart = recordings_apart(*homogeneity, dataset.recordings.view());
  return {std::move(homogeneity), std::move(apart)};
}

/// rad, between the headings of a drive, of the recording that has the most.
double span_of_headings(const Findings& found) {
  const auto& [effects, fit] = found.outcome.model;
  double widest = 0.0;
  for (const auto& model : found.fit.dataset.models) {
    const std::vector<math::Pose> path = model->trajectory(vehicle::as_span(fit.parameters), effects).poses();
    const auto [right, left] = std::minmax_element(
        path.begin(), path.end(), [](const math::Pose& a, const math::Pose& b) { return a.yaw < b.yaw; });
    if (!path.empty()) widest = std::max(widest, left->yaw - right->yaw);
  }
  return widest;
}

/// Where a lidar sits shows in turns alone, by its lever: in a drive that hardly turns an error of the places
/// that grows with the heading is taken for a lever.
/// @return m^2, of either coordinate
double variance_of_lever(const Findings& found) {
  if (!found.fit.dataset.reference_is_scans()) return 0.0;
  const double span = span_of_headings(found);
  if (!(span > 0.0) || span > settings::kFewHeadings_rad) return 0.0;
  const double error = settings::kErrorOfOneHeading_m / span;
  return error * error;
}

BaseEstimate base_estimate(const Findings& found, const Agreement& agreement,
                           const estimation::GyroFit& gyros) {
  const wheels::BaseParameters base = vehicle::to_base(vehicle::as_span(gyros.parameters));
  Eigen::MatrixXd covariance = with_scale_error(gyros.covariance, base, scale_deviation(found));
  covariance.block<2, 2>(vehicle::kMountX, vehicle::kMountX).diagonal().array() += variance_of_lever(found);
  QuantityList measured = base_quantities(base, covariance);
  if (agreement.apart)
    covariance.topLeftCorner<vehicle::kBaseCount, vehicle::kBaseCount>().diagonal() +=
        agreement.homogeneity->between;
  for (const Eigen::VectorXd& uncertainty : found.outcome.model_uncertainties)
    covariance.topLeftCorner<vehicle::kBaseCount, vehicle::kBaseCount>() +=
        uncertainty * uncertainty.transpose();
  QuantityList stated = base_quantities(base, covariance);
  return {std::move(measured), std::move(stated), std::move(covariance)};
}

/// The six base parameters alone, on the same pairs: what the effects are measured against.
PlainFit plain_fit(const Findings& found) {
  const estimation::FitResult& fit = found.outcome.model.fit;
  if (found.outcome.model.effects.empty()) return fit;
  estimation::FitOptions options;
  options.fixed = found.fit.dataset.fixed();
  auto plain = fit_joint(found.fit.dataset.data, {}, fit.parameters.head(vehicle::kBaseCount), options);
  return plain ? PlainFit(std::move(plain).value()) : std::nullopt;
}

using HeldOutErrors = std::vector<validation::HeldOutError>;

HeldOutErrors held_out(const Findings& found) {
  const measurement::Dataset& dataset = found.fit.dataset;
  const auto& [effects, fit] = found.outcome.model;
  return validation::held_out_errors(dataset.data, effects, fit,
                                     vehicle::fixed_with(dataset.fixed(), effects));
}

ResidualReport residual(const Findings& found, const PlainFit& plain, const HeldOutErrors& of_all) {
  const measurement::Dataset& dataset = found.fit.dataset;
  const auto& [effects, fit] = found.outcome.model;
  const auto of_plain = effects.empty() || !plain
                            ? of_all
                            : validation::held_out_errors(dataset.data, {}, *plain, dataset.fixed());
  const auto after = validation::held_out_residual(of_all, of_plain);
  const auto before = validation::held_out_residual(of_plain, of_all);
  if (!after || !before) return {false, {}, {}, {}};
  return {true, before->rms, after->rms, after->noise_floor};
}

/// Events in so few pairs that a robust fit leaves them out are no part of the model, but something that a
/// user should know.
Outliers outliers_of(const Findings& found) {
  const auto& data = found.fit.dataset.data;
  const auto& [effects, fit] = found.outcome.model;
  Outliers outliers = report::trace_outliers(data, fit);
  if (!outliers) return outliers;
  outliers->of_poses = found.fit.dataset.reference_is_base();
  if (!outliers->of_poses) outliers->cause = report::cause_of_outliers(data, effects, fit);
  return outliers;
}

/// Smooth terms without a name; without these, of what was searched, what goes with outliers; and where
/// nothing at all is reported although odometry is plainly off, what failed cross-validation.
std::optional<Unexplained> unexplained(const Findings& found, const Outliers& outliers, bool has_effects,
                                       const std::vector<DriveError>& drive_errors) {
  if (auto smooths = unnamed_smooths(found)) return smooths;
  if (!found.was_searched) return std::nullopt;
  if (auto flagged = outliers ? flagged_outliers(*outliers) : std::nullopt) return flagged;
  if (has_effects || !odometry_is_off(drive_errors)) return std::nullopt;
  return failed_validation(found.outcome);
}

/// Fills the members that not every file has.
void add_evidence(const Findings& found, const SmoothTerms& smooths, const Outliers& outliers,
                  const estimation::GyroFit& gyros, const HeldOutErrors& errors, Calibration& calibration) {
  calibration.curves = entries_of(smooths);
  calibration.lidar_curves = selection::lidar_curves(found.lidar);
  if (outliers) calibration.outliers = entry_of(*outliers);
  if (const auto noise = contact_noise(found.fit.dataset, found.outcome.model, errors))
    calibration.contact_noise = odometry::entry_of(*noise);
  const ingest::StampReport& stamps = found.fit.dataset.recordings.stamps();
  if (stamps.any()) calibration.stamps = entry_of(stamps);
  calibration.gyros = entries_of(gyros, found.fit.dataset.recordings.view());
  calibration.considered = selection::entries_of(found.outcome.considered);
}

std::vector<std::string> remarks_in(const Findings& found, const SmoothTerms& smooths,
                                    const Outliers& outliers, const estimation::GyroFit& gyros) {
  std::vector<std::string> sentences = found.remarks;
  if (outliers) sentences.push_back(to_text(*outliers));
  for (const std::string& remark : remarks_on(found.fit.dataset.recordings.stamps()))
    sentences.push_back(remark);
  for (const std::string& remark : remarks_on(gyros, found.fit.dataset.recordings.view()))
    sentences.push_back(remark);
  const math::Pose mount = vehicle::to_base(vehicle::as_span(found.outcome.model.fit.parameters)).mount;
  for (const terms::FittedSmoothTerm& smooth : smooths)
    if (happens_at_once(smooth.smooth)) sentences.push_back(selection::event_to_text(smooth, mount));
  return sentences;
}

/// The one of these recordings whose scans have the fewest readings.
const measurement::PairSet& thinnest_scans(std::span<const measurement::PairSet> sets) {
  return *std::min_element(sets.begin(), sets.end(), [](const auto& a, const auto& b) {
    return a.readings * b.beams < b.readings * a.beams;
  });
}

/// Counts the pairs of scans by their outcome.
void count_matches(std::span<const measurement::PairSet> sets, VerdictEvidence& evidence) {
  const std::string too_thin = "match: " + matching::to_string(matching::MatchStatus::too_few_points);
  for (const measurement::PairSet& set : sets) {
    evidence.matched += set.pairs.size();
    evidence.partial += set.partial;
    evidence.unmatched += set.unmatched;
    if (const auto thin = set.rejected.find(too_thin); thin != set.rejected.end())
      evidence.too_thin += thin->second;
    evidence.stood += set.stood;
  }
  const measurement::PairSet& thinnest = thinnest_scans(sets);
  evidence.readings = thinnest.readings;
  evidence.beams = thinnest.beams;
}

/// The evidence that the verdict stands on.
VerdictEvidence evidence(const Findings& found, const BaseEstimate& base, const ReportData& data,
                         const std::optional<Disagreement>& apart, std::vector<std::string> remarks) {
  const estimation::FitResult& fit = found.outcome.model.fit;
  VerdictEvidence evidence;
  evidence.remarks = std::move(remarks);
  evidence.drive_errors = data.drive_errors;
  evidence.axes = data.axes;
  evidence.outliers = fit.discarded;
  evidence.pairs = fit.used + fit.discarded;
  evidence.losses = losses_of(found.fit.dataset.recordings.view());
  evidence.recordings_apart = apart;
  evidence.of_poses = found.fit.dataset.reference_is_base();
  evidence.motion = found.fit.dataset.recordings.front().motion;
  evidence.converged = fit.converged;
  evidence.measured = base.measured;
  evidence.missing_motion =
      classical::missing_motion(measurement::wheel_motions(found.fit.dataset.data, 0.0));
  if (!found.fit.dataset.reference_is_scans() || found.every_scan_placed) return evidence;
  count_matches(found.fit.dataset.pair_sets, evidence);
  return evidence;
}

/// Where hardly any scan matched, a fit that failed has nothing to say but that.
Error cause_of(const Error& error, std::span<const measurement::PairSet> sets) {
  VerdictEvidence evidence;
  count_matches(sets, evidence);
  const auto what = poor_matches(evidence);
  if (!what) return error;
  return {ErrorCode::refused, *what, "scan matching",
          remedy_for_readings(evidence).value_or(
              "drive where the lidar sees walls on all sides, not along a corridor")};
}

Calibration begun(const ingest::Recordings& recordings, std::span<const measurement::PairSet> sets) {
  Calibration calibration;
  if (recordings.size() > 0) calibration.robot = recordings.front().robot;
  calibration.driven = driven_in(recordings.view());
  calibration.data = data_use(recordings.view(), sets);
  calibration.discarded = left_out(recordings.view(), sets);
  calibration.repairs = repairs_of(recordings);
  for (const Recording& recording : recordings.view())
    calibration.recordings.push_back(
        {recording.name, recording.robot.robot_id, std::nullopt, std::nullopt, {}});
  return calibration;
}

Calibration with_classical_methods(const estimation::Fit& fit, const classical::ClosedFormOptions& cuts) {
  Calibration calibration = begun(fit.dataset.recordings, fit.dataset.pair_sets);
  calibration.methods = classical_methods(fit.dataset, delay_of(fit.model), cuts, calibration);
  return calibration;
}

/// Where most of a recording was left out, whatever failed then failed for that.
Calibration refused(Calibration calibration, const ingest::Recordings& recordings, const Error& error) {
  calibration.verdict = Verdict::refused;
  calibration.reasons.clear();
  for (const Loss& loss : losses_of(recordings.view()))
    if (const auto refusing = too_much_left_out(loss)) calibration.reasons.push_back(refusing->reason);
  calibration.reasons.push_back(error.text());
  calibration.next_step = calibration.reasons.size() > 1 ? kMendLosses : next_after(error);
  return calibration;
}

}  // namespace

Calibration refused(const ingest::Recordings& recordings, const Error& error) {
  return refused(begun(recordings, {}), recordings, error);
}

Calibration refused(const measurement::Dataset& dataset, const Error& error) {
  return refused(begun(dataset.recordings, dataset.pair_sets), dataset.recordings, error);
}

Calibration refused(const estimation::Fit& failed, const classical::ClosedFormOptions& cuts) {
  Calibration calibration = with_classical_methods(failed, cuts);
  MethodResult joint;
  joint.name = "joint";
  joint.refused = failed.failure->what;
  calibration.methods.push_back(joint);
  return refused(std::move(calibration), failed.dataset.recordings,
                 cause_of(*failed.failure, failed.dataset.pair_sets));
}

Calibration calibrated(const Findings& found) {
  const estimation::FitResult& fit = found.outcome.model.fit;
  const PlainFit plain = plain_fit(found);
  const estimation::GyroFit gyros = estimation::fit_gyros(found.fit.dataset.data, found.outcome.model.effects,
                                                          fit, found.fit.dataset.recordings.view());
  const Agreement together = agreement(found);
  const BaseEstimate base = base_estimate(found, together, gyros);
  const SmoothTerms smooths = found_smooths(found);
  const Outliers outliers = outliers_of(found);
  const ReportData data = make_report_data(found.fit.dataset, found.outcome, plain);

  Calibration calibration = with_classical_methods(found.fit, found.cuts);
  calibration.methods.push_back(joint_method(fit));
  for (Discarded& one : outlier_pairs(found.fit.dataset, fit))
    calibration.discarded.push_back(std::move(one));
  calibration.parameters = base.stated;
  calibration.covariance_order = base_quantity_names();
  calibration.covariance = diameter_covariance(base.covariance);
  const HeldOutErrors errors = held_out(found);
  calibration.residual = residual(found, plain, errors);
  calibration.effects = found_effects(found, plain);
  calibration.unexplained = unexplained(found, outliers, !calibration.effects.empty(), data.drive_errors);
  add_evidence(found, smooths, outliers, gyros, errors, calibration);
  store_report_data(data, calibration);
  if (together.homogeneity)
    store_homogeneity(*together.homogeneity, found.fit.dataset.recordings.view(), calibration);

  const GateResult gate = judge(
      calibration, evidence(found, base, data, together.apart, remarks_in(found, smooths, outliers, gyros)));
  calibration.verdict = gate.verdict;
  calibration.reasons = gate.reasons;
  calibration.next_step = gate.next_step;
  return calibration;
}

}  // namespace odomcalib::calib::report
