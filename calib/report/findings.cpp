#include "calib/report/findings.hpp"

#include <algorithm>
#include <cmath>

#include "calib/report/gate.hpp"
#include "calib/report/one_robot.hpp"
#include "calib/report/report.hpp"
#include "calib/report/report_data.hpp"
#include "calib/selection/event_text.hpp"
#include "calib/selection/held_out.hpp"
#include "calib/selection/lidar_report.hpp"
#include "calib/selection/metre.hpp"
#include "calib/selection/outlier_trace.hpp"
#include "calib/selection/search_round.hpp"
#include "calib/selection/settings.hpp"
#include "calib/selection/tracing_json.hpp"
#include "calib/terms/basis.hpp"

namespace odomcalib::calib::report {
namespace {

/// What stays without a name, put together from its parts.
class UnnamedSummary {
 public:
  void mention(const std::string& variable) {
    auto& names = all_.depends_on;
    if (std::find(names.begin(), names.end(), variable) == names.end()) names.push_back(variable);
  }
  void add(const std::string& variable, double p_value, double before, double after) {
    if (all_.depends_on.empty()) all_.p_value = p_value;
    mention(variable);
    const double ratio = before > 0.0 ? after / before : 1.0;
    left_ *= std::min(ratio * ratio, 1.0);
  }
  [[nodiscard]] std::optional<Unexplained> result() const {
    if (all_.depends_on.empty()) return std::nullopt;
    Unexplained out = all_;
    out.share = 1.0 - left_;
    return out;
  }

 private:
  Unexplained all_;
  double left_ = 1.0;  // of the squared error
};

class Filler {
 public:
  Filler(const Findings& found, Calibration& calibration) : found_(found), calibration_(calibration) {}

  void run() {
    const estimation::FitResult& fit = found_.outcome.model.fit;
    const std::span<const double> p = vehicle::as_span(fit.parameters);
    Eigen::MatrixXd covariance = with_scale_error(fit.covariance, vehicle::to_base(p), scale_deviation());
    measured_ = base_quantities(vehicle::to_base(p), covariance);
    compare_recordings();
    if (apart_)
      covariance.topLeftCorner<vehicle::kBaseCount, vehicle::kBaseCount>().diagonal() += homogeneity_->between;
    for (const Eigen::VectorXd& doubt : found_.outcome.doubts)
      covariance.topLeftCorner<vehicle::kBaseCount, vehicle::kBaseCount>() += doubt * doubt.transpose();
    calibration_.parameters = base_quantities(vehicle::to_base(p), covariance);
    calibration_.covariance_order = base_quantity_names();
    calibration_.covariance = diameter_covariance(covariance);
    calibration_.methods.push_back(joint_method(fit));
    fit_plain();
    fill_residual();
    fill_effects();
    fill_unnamed();
    fill_outliers();
    if (found_.stamps.any()) calibration_.extensions["stamps"] = to_json(found_.stamps);
    if (!found_.outcome.considered.empty())
      calibration_.extensions["considered"] = considered_to_json(found_.outcome.considered);
    const ReportData report = make_report_data(found_.session, found_.outcome, plain_);
    store_report_data(report, calibration_);
    if (odometry_is_off(report.drive_errors)) tell_what_failed_its_proof();
    const GateResult gate = judge(calibration_, footing(report));
    calibration_.verdict = gate.verdict;
    calibration_.reasons = gate.reasons;
  }

 private:
  /// With what was found in all of them each recording is asked alone.
  void compare_recordings() {
    const auto recordings = found_.session.recordings();
    if (recordings.size() < 2) return;
    std::vector<std::string> names;
    for (const Recording& recording : recordings) names.push_back(recording.name);
    const selection::FitTask task{found_.session.data(), found_.session.fixed(0)};
    const double metre = found_.session.reference_is_scans() ? kMatcherScale : 0.0;
    homogeneity_ = selection::homogeneity(task, found_.outcome.model, metre, names);
    if (!homogeneity_) return;
    store_homogeneity(*homogeneity_, recordings, calibration_);
    apart_ = recordings_apart(*homogeneity_, recordings);
  }

  [[nodiscard]] const vehicle::EffectList& effects() const { return found_.outcome.model.effects; }
  [[nodiscard]] std::vector<bool> fixed() const {
    return vehicle::fixed_with(found_.session.fixed(0), effects());
  }

  /// Matches of keyframes are not free of bias; neither is a model with a law that was found to fit, whose
  /// true shape nobody knows (a delay may be a filter). Places in a map are, as far as simulated drives tell.
  [[nodiscard]] double scale_deviation() const {
    if (!found_.session.reference_is_scans()) return 0.0;
    if (found_.every_scan_placed && effects().empty() && found_.lidar.empty()) return 0.0;
    return std::hypot(kMatcherScale, selection::metre_in_doubt(found_.lidar, found_.session.recordings()));
  }

  [[nodiscard]] Footing footing(const ReportData& report) const {
    Footing footing;
    footing.drive_errors = report.drive_errors;
    footing.axes = report.axes;
    footing.outliers = found_.outcome.model.fit.discarded;
    footing.pairs = found_.outcome.model.fit.used + footing.outliers;
    footing.of_poses = found_.session.reference_is_base();
    footing.converged = found_.outcome.model.fit.converged;
    footing.measured = measured_;
    footing.remarks = found_.remarks;
    footing.recordings_apart = apart_;
    if (outliers_) footing.remarks.push_back(to_text(*outliers_));
    for (const std::string& remark : remarks_on(found_.stamps)) footing.remarks.push_back(remark);
    const math::Pose mount = vehicle::to_base(vehicle::as_span(found_.outcome.model.fit.parameters)).mount;
    for (const selection::FittedCurve& curve : fitted_curves_)
      if (happens_at_once(curve.curve)) footing.remarks.push_back(event_to_text(curve, mount));
    if (!found_.session.reference_is_scans() || found_.every_scan_placed) return footing;
    for (const measurement::PairSet& set : found_.session.pair_sets()) {
      footing.matched += set.pairs.size();
      footing.unmatched += set.unmatched;
    }
    return footing;
  }

  /// The six base parameters alone, on the same pairs: what the effects are measured against.
  void fit_plain() {
    if (effects().empty()) {
      plain_ = found_.outcome.model.fit;
      return;
    }
    estimation::FitOptions options;
    options.fixed = found_.session.fixed(0);
    auto plain = fit_joint(found_.session.data(), {},
                           found_.outcome.model.fit.parameters.head(vehicle::kBaseCount), options);
    if (plain) plain_ = std::move(plain).value();
  }

  void fill_residual() {
    const auto& data = found_.session.data();
    const auto of_all = selection::held_out_errors(data, effects(), found_.outcome.model.fit, fixed());
    const auto of_plain = effects().empty() || !plain_
                              ? of_all
                              : selection::held_out_errors(data, {}, *plain_, found_.session.fixed(0));
    const auto after = selection::held_out_residual(of_all, of_plain);
    const auto before = selection::held_out_residual(of_plain, of_all);
    calibration_.residual.held_out = after && before;
    if (!after || !before) return;
    calibration_.residual.after = after->rms;
    calibration_.residual.noise_floor = after->noise_floor;
    calibration_.residual.before = before->rms;
  }

  [[nodiscard]] const selection::Finding* finding_of(const vehicle::Effect* effect) const {
    for (const selection::Finding& finding : found_.outcome.findings)
      if (finding.effect.get() == effect) return &finding;
    return nullptr;
  }

  /// Evidence for an effect that the search did not add: the delay found before it, or what the user asked
  /// for.
  [[nodiscard]] Evidence evidence_against_plain(double z) const {
    Evidence evidence;
    evidence.p_value = std::erfc(z / std::sqrt(2.0));
    if (!plain_) return evidence;
    const auto& data = found_.session.data();
    const estimation::FitResult& fit = found_.outcome.model.fit;
    const auto windows = find_stretches(selection::StretchKind::open_loop, data, selection::folds_of(data),
                                        fit, selection::trusted_pairs(*plain_, fit));
    if (windows.size() < selection::settings::kFewestWindows) return evidence;
    evidence.held_out_before =
        stretch_errors(data, windows, {}, *plain_, found_.session.fixed(0)).rms_position();
    evidence.held_out_after = stretch_errors(data, windows, effects(), fit, fixed()).rms_position();
    return evidence;
  }

  void fill_effects() {
    calibration_.effects = selection::effect_results(found_.lidar);
    if (found_.was_searched)
      for (EffectResult& effect : effects_of(found_.stamps))
        calibration_.effects.push_back(std::move(effect));
    Eigen::Index index = vehicle::kBaseCount;
    for (const auto& effect : effects()) {
      const auto curve = std::find_if(found_.outcome.curves.begin(), found_.outcome.curves.end(),
                                      [&](const selection::AddedCurve& c) { return c.effect == effect; });
      if (curve != found_.outcome.curves.end())
        fitted_curves_.push_back(fitted(*curve, index));
      else if (!contains(found_.outcome.quiet, effect))
        calibration_.effects.push_back(describe(*effect, index));
      index += static_cast<Eigen::Index>(effect->parameters().size());
    }
    if (!fitted_curves_.empty())
      calibration_.extensions[selection::kCurvesMember] = curves_to_json(fitted_curves_);
  }

  static bool contains(const vehicle::EffectList& list,
                       const std::shared_ptr<const vehicle::Effect>& effect) {
    return std::find(list.begin(), list.end(), effect) != list.end();
  }

  [[nodiscard]] selection::FittedCurve fitted(const selection::AddedCurve& added, Eigen::Index index) const {
    selection::FittedCurve curve{added.curve, {}, added.law_of ? added.law_of->name() : ""};
    for (std::size_t k = 0; k < basis_size(added.curve); ++k)
      curve.coefficients.push_back(found_.outcome.model.fit.parameters(index++));
    return curve;
  }

  /// @param index of the effect's first parameter in the parameter vector
  [[nodiscard]] EffectResult describe(const vehicle::Effect& effect, Eigen::Index index) const {
    EffectResult result;
    result.name = effect.name();
    double z = 0.0;
    for (const vehicle::EffectParameter& parameter : effect.parameters()) {
      const double value = found_.outcome.model.fit.parameters(index);
      const double deviation = std::sqrt(std::max(found_.outcome.model.fit.covariance(index, index), 0.0));
      // What the data do not speak of has no deviation, rather than none at all.
      const bool is_estimated = !parameter.fixed && deviation > 0.0;
      result.parameters.push_back({parameter.name, {value, is_estimated ? deviation : -1.0, parameter.unit}});
      if (deviation > 0.0 && parameter.start == 0.0) z = std::max(z, std::abs(value) / deviation);
      ++index;
    }
    const selection::Finding* finding = finding_of(&effect);
    result.aliases = finding != nullptr ? finding->aliases : effect.always_alike();
    result.evidence = finding != nullptr ? Evidence{finding->proof.family_p_value, finding->proof.before,
                                                    finding->proof.after}
                                         : evidence_against_plain(z);
    return result;
  }

  /// Curves without a name: variables they depend on, in the order found.
  void fill_unnamed() {
    UnnamedSummary summary;
    for (const terms::LidarFinding& finding : found_.lidar)
      if (!finding.effect->is_named() && !completes(finding, found_.lidar))
        summary.add(finding.effect->name(), finding.family_p_value, finding.before, finding.after);
    for (const selection::AddedCurve& added : found_.outcome.curves)
      if (!added.law_of)
        summary.add(to_string(added.curve.law.variable), added.proof.family_p_value, added.proof.before,
                    added.proof.after);
    for (const selection::AddedCurve& added : found_.outcome.curves) {
      if (added.law_of) continue;
      for (const vehicle::Variable variable : added.alike) summary.mention(to_string(variable));
    }
    calibration_.unexplained = summary.result();
    const auto has_no_name = [](const terms::LidarFinding& finding) { return !finding.effect->is_named(); };
    if (std::any_of(found_.lidar.begin(), found_.lidar.end(), has_no_name))
      calibration_.extensions[selection::kLidarCurvesMember] = selection::lidar_curves_to_json(found_.lidar);
  }

  /// What happened in so few pairs that a robust fit leaves them out is no part of the model, but something
  /// that a user should know.
  void fill_outliers() {
    outliers_ = selection::trace_outliers(found_.session.data(), found_.outcome.model.fit);
    if (!outliers_) return;
    outliers_->cause =
        selection::cause_of_outliers(found_.session.data(), effects(), found_.outcome.model.fit);
    calibration_.extensions["outliers"] = to_json(*outliers_);
    if (!found_.was_searched || calibration_.unexplained || outliers_->depends_on.empty()) return;
    flag(outliers_->depends_on, outliers_->p_value);
  }

  /// Where odometry is plainly off and nothing is told of it, what goes with it is, although no law of it
  /// foretells anything: it is not compensated.
  void tell_what_failed_its_proof() {
    if (!found_.was_searched || calibration_.unexplained || !calibration_.effects.empty()) return;
    const selection::Considered* best = nullptr;
    for (const selection::Considered& one : found_.outcome.considered)
      if (!one.depends_on.empty() && one.family_p_value <= selection::settings::kNamedLevel &&
          (best == nullptr || one.statistic > best->statistic))
        best = &one;
    if (best != nullptr) flag(best->depends_on, best->family_p_value);
  }

  /// What goes with variables, but is no part of the model.
  void flag(const std::vector<vehicle::Variable>& variables, double p_value) {
    calibration_.unexplained = Unexplained{{}, p_value, 0.0};
    for (const vehicle::Variable variable : variables)
      calibration_.unexplained->depends_on.push_back(to_string(variable));
  }

  const Findings& found_;
  Calibration& calibration_;
  std::optional<selection::OutlierTrace> outliers_;
  std::optional<estimation::FitResult> plain_;
  std::optional<selection::Homogeneity> homogeneity_;
  std::optional<Apart> apart_;
  QuantityList measured_;  ///< with the deviations that the motion leaves
  std::vector<selection::FittedCurve> fitted_curves_;
};

}  // namespace

void fill_calibration(const Findings& found, Calibration& calibration) { Filler(found, calibration).run(); }

}  // namespace odomcalib::calib::report
