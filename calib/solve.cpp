#include "calib/solve.hpp"

#include <utility>

#include "calib/estimation/fit.hpp"
#include "calib/estimation/start_values.hpp"
#include "calib/report/findings.hpp"
#include "calib/selection/clocks.hpp"
#include "calib/selection/lidar_correction.hpp"
#include "calib/selection/placed_fit.hpp"
#include "calib/selection/reference_seat.hpp"
#include "calib/selection/scan_times.hpp"
#include "calib/selection/search.hpp"

namespace odomcalib::calib {
namespace {

/// What is missing from the fitted model, where that is to be looked for.
selection::SearchResult select_terms(const estimation::Fit& fit, bool is_wanted, const Progress& progress) {
  selection::SearchResult found;
  found.model = {fit.model.effects, fit.result};
  if (!is_wanted || fit.dataset.has_motions_alone()) return found;
  found = selection::search_effects(fit.dataset.data, fit.model.effects, fit.result, fit.dataset.fixed(),
                                    [&](double fraction) { progress("tracing the residual", fraction); });
  return without_idle_delay({fit.dataset.data, fit.dataset.fixed()}, std::move(found));
}

}  // namespace

Calibration solve(std::span<const Recording> recordings, const SolveOptions& options,
                  const Progress& callback) {
  const Progress progress = callback ? callback : [](const std::string&, double) {};

  const ingest::Recordings repaired = ingest::with_even_ticks(recordings);
  auto opened = measurement::open_dataset(repaired);
  if (!opened) return report::refused(repaired, opened.error());
  const auto request = terms::request_for(options.effects);
  if (!request) return report::refused(repaired, request.error());

  progress("matching", 0.0);
  measurement::Dataset rough = measured_roughly(std::move(opened).value());
  const auto start = estimation::start_model(rough, request.value());
  if (!start) return report::refused(rough, start.error());

  // A stage that does not apply, that is rejected, or that follows a failed fit hands on the fit as it is.
  const estimation::Settling how = selection::settling(request.value().is_automatic, progress);
  estimation::Fit fit = settle(std::move(rough), start.value(), how);
  fit = selection::seat_reference(std::move(fit), how);
  fit = selection::even_out_scans(std::move(fit), how);
  fit = selection::let_scans_sweep(std::move(fit), request.value(), how);
  auto [corrected, lidar, placement] = selection::correct_lidar(std::move(fit), request.value(), how);
  placement = selection::placement_of(corrected, std::move(placement), progress);
  fit = selection::locate(std::move(corrected), placement);
  if (fit.failure) return report::refused(fit);

  selection::SearchResult found = select_terms(fit, request.value().is_automatic, progress);
  const auto [outcome, every_scan_placed] =
      selection::fit_to_every_scan(std::move(found), fit.dataset, std::move(placement), progress);

  progress("validating", 0.0);
  Calibration calibration =
      report::calibrated({fit, outcome, lidar, request.value().is_automatic, every_scan_placed});
  progress("validating", 1.0);
  return calibration;
}

}  // namespace odomcalib::calib
