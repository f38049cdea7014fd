#include "calib/selection/scan_times.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "calib/ingest/sweeps.hpp"
#include "calib/measurement/scan_stamps.hpp"
#include "calib/selection/criterion.hpp"

namespace odomcalib::calib::selection {
namespace {

/// The recordings of the fit with even stamps where the motion is that of even times; nothing where all
/// stamps are right.
std::optional<ingest::Recordings> with_even_scans(const estimation::Fit& fit) {
  const ingest::Recordings& given = fit.dataset.recordings;
  ingest::Repairs repairs(given.view());
  ingest::StampReport stamps = given.stamps();
  for (std::size_t i = 0; i < given.size(); ++i) {
    const auto even = even_scans(given[i], fit.dataset.data[i], fit.model.effects, fit.model.parameters);
    if (!even) continue;
    ingest::set_stamps(repairs.own(i).scans, even->t);
    stamps.scans = std::max(stamps.scans, even->jitter);
  }
  if (!repairs.any()) return std::nullopt;
  return std::move(repairs).take(stamps);
}

/// A delay that is fitted anyway is counted from the middle of a sweep.
estimation::Fit fit_to_sweeps(measurement::Dataset sweeping, const terms::Request& request,
                              const estimation::Settling& how) {
  estimation::Fit fit = fit_anew(std::move(sweeping), request, how);
  if (fit.failure || !place_of(fit.model.effects, vehicle::ClockPart::offset)) return fit;
  const ingest::Recordings moved = ingest::stamped_in_the_middle(fit.dataset.recordings);
  return measure_and_settle(with_scans_of(std::move(fit.dataset), moved), std::move(fit.model), how);
}

}  // namespace

estimation::Fit even_out_scans(estimation::Fit fit, const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_scans()) return fit;
  const auto even = with_even_scans(fit);
  if (!even) return fit;
  return measure_and_settle(with_scans_of(std::move(fit.dataset), *even), std::move(fit.model), how);
}

estimation::Fit let_scans_sweep(estimation::Fit fit, const terms::Request& request,
                                const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_scans()) return fit;
  const auto sweeping = ingest::with_sweeps(fit.dataset.recordings);
  if (!sweeping) return fit;
  estimation::Fit swept = fit_to_sweeps(with_scans_of(fit.dataset, *sweeping), request, how);
  const auto before = held_out_residual(fit), after = held_out_residual(swept);
  if (!is_clearly_better(before, after)) return fit;
  ingest::StampReport stamps = swept.dataset.recordings.stamps();
  stamps.sweep_p_value = p_value_of(*before, *after);
  swept.dataset.recordings = swept.dataset.recordings.reported_as(stamps);
  return swept;
}

}  // namespace odomcalib::calib::selection
