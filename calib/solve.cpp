#include "calib/solve.hpp"

#include <utility>

#include "calib/estimation/clock_leap.hpp"
#include "calib/estimation/clock_step.hpp"
#include "calib/estimation/first_look.hpp"
#include "calib/estimation/fit.hpp"
#include "calib/estimation/start_values.hpp"
#include "calib/ingest/one_sensor.hpp"
#include "calib/ingest/phantom_return.hpp"
#include "calib/ingest/put_right.hpp"
#include "calib/ingest/recording_check.hpp"
#include "calib/ingest/recordings.hpp"
#include "calib/report/findings.hpp"
#include "calib/report/gate.hpp"
#include "calib/report/report_data.hpp"
#include "calib/selection/search.hpp"
#include "calib/stages/fit_stages.hpp"
#include "calib/stages/lidar_correction.hpp"
#include "calib/stages/placed_fit.hpp"
#include "calib/stages/recording_clocks.hpp"

namespace odomcalib::calib {
namespace {

/// Terms that are missing from the fitted model, where they are to be looked for.
selection::SearchResult select_terms(const estimation::Fit& fit, bool is_wanted,
                                     const selection::RuleSet& rules, const Progress& progress) {
  selection::SearchResult found;
  found.model = {fit.model.effects, fit.result};
  if (!is_wanted || fit.dataset.has_motions_alone()) return found;
  found =
      selection::search_effects(fit.dataset.data, fit.model.effects, fit.result, fit.dataset.fixed(), rules,
                                [&](double fraction) { progress("tracing the residual", fraction); });
  return stages::without_idle_delay({fit.dataset.data, fit.dataset.fixed()}, std::move(found));
}

/// The error that makes any fit of the recordings meaningless, as far as it shows before scans are matched
/// from where the counts say they are.
std::optional<Error> contradiction(const ingest::Recordings& recordings, bool same_robot) {
  if (auto error = ingest::two_robots(recordings.view(), same_robot)) return error;
  if (auto error = ingest::two_sensors(recordings.view())) return error;
  for (const Recording& recording : recordings.view())
    for (const auto look : {estimation::counts_without_direction, estimation::odometry_beside_axle})
      if (auto error = look(recording)) return error;
  return std::nullopt;
}

/// @param remarks on what was taken out of the recordings
Solution calibrate(measurement::Dataset opened, const terms::Request& request, const SolveOptions& options,
                   const std::vector<std::string>& remarks, const Progress& progress) {
  progress("matching", 0.0);
  measurement::Dataset rough =
      estimation::without_clock_steps(measured_roughly(estimation::without_clock_leaps(std::move(opened))));
  const auto start = estimation::start_model(rough, request);
  if (!start) return {report::refused(rough, start.error()), {}};

  // A stage that does not apply, that is rejected, or that follows a failed fit hands on the fit as it is.
  const estimation::Settling how = stages::settling(request.is_automatic, progress);
  estimation::Fit fit = settle(std::move(rough), start.value(), how);
  fit = stages::mount_reference(std::move(fit), how);
  fit = stages::align_clocks(std::move(fit), request, how);
  fit = stages::choose_scan_stamps(std::move(fit), how);
  fit = stages::choose_sweep_timing(std::move(fit), request, how);
  auto [corrected, lidar, placement] = stages::correct_lidar(std::move(fit), request, how, options.rules);
  placement = stages::placement_of(corrected, std::move(placement), progress);
  fit = stages::locate(std::move(corrected), placement);
  if (fit.failure) return {report::refused(fit, options.cuts), {}};

  selection::SearchResult found = select_terms(fit, request.is_automatic, options.rules, progress);
  const auto [outcome, every_scan_placed] =
      stages::fit_to_every_scan(std::move(found), fit.dataset, std::move(placement), progress);

  progress("validating", 0.0);
  Calibration calibration = report::calibrated(
      {fit, outcome, lidar, request.is_automatic, every_scan_placed, remarks, options.cuts});
  progress("validating", 1.0);
  return {std::move(calibration),
          report::sample_pairs(fit.dataset, outcome.model.effects, outcome.model.fit)};
}

}  // namespace

Solution solve_with_pairs(std::span<const Recording> recordings, const SolveOptions& options,
                          const Progress& callback) {
  const Progress progress = callback ? callback : [](const std::string&, double) {};

  const ingest::Recordings mended = ingest::put_right(recordings, options.sensor);
  const ingest::Recordings whole = options.same_lidar ? ingest::of_one_name(mended) : mended;
  const auto scale = options.scale ? options.scale : ingest::scale_by_data_sheet(whole.view());
  const ingest::Recordings scaled = ingest::with_scale(whole.view(), scale ? scale->value : 1.0);
  const ingest::Cleaned cleaned = ingest::without_phantom_returns(scaled.view());
  const ingest::Recordings repaired = ingest::with_even_ticks(cleaned.recordings.view());
  auto opened = measurement::open_dataset(repaired);
  if (!opened) return {report::refused(repaired, opened.error()), {}};
  if (const auto error = contradiction(repaired, options.same_robot))
    return {report::refused(repaired, *error), {}};
  const auto request = terms::request_for(options.effects);
  if (!request) return {report::refused(repaired, request.error()), {}};

  Solution solution =
      calibrate(std::move(opened).value(), request.value(), options, cleaned.remarks, progress);
  solution.calibration = report::explained(whole.view(), std::move(solution.calibration));
  if (scale && !solution.calibration.parameters.empty()) solution.calibration.scale = *scale;
  return solution;
}

}  // namespace odomcalib::calib
