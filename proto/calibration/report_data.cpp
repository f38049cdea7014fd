#include "proto/calibration/report_data.hpp"

#include <cmath>
#include <initializer_list>

#include "proto/calibration/calibration.hpp"

namespace odomcalib {
namespace {

/// Six significant digits: more than a picture shows, and the file stays small.
double rounded(double value) {
  if (!std::isfinite(value) || value == 0.0) return std::isfinite(value) ? 0.0 : std::nan("");
  const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : value;
}

/// Whole millimetres.
double millimetres(double metres) {
  constexpr double kParts = 1000.0;
  return rounded(std::round(metres * kParts) / kParts);
}

void round_off(std::initializer_list<double*> values) {
  for (double* value : values) *value = rounded(*value);
}

void round_off(std::optional<double>& value) {
  if (value && std::isfinite(*value))
    value = rounded(*value);
  else
    value.reset();
}

template <typename Numbers>
void round_each(Numbers& values) {
  for (double& value : values) value = rounded(value);
}

void round_off(std::optional<Bounded>& figure) {
  if (figure) round_off({&figure->value, &figure->low, &figure->high});
}

void round_off(DriveError& error) {
  round_off(error.before);
  round_off(error.geometry);
  round_off(error.after);
  round_off(error.noise_floor);
}

void round_off(ErrorGrowth& growth) {
  round_off({&growth.way});
  growth.stretches = static_cast<std::size_t>(rounded(static_cast<double>(growth.stretches)));
  round_off(growth.before);
  round_off(growth.geometry);
  round_off(growth.after);
}

void round_off(ResidualTrace& trace) {
  round_off({&trace.explained});
  for (auto& p : trace.points) round_off({&p.variable, &p.before, &p.after});
  for (auto& b : trace.bins) round_off({&b.variable, &b.before, &b.before_error, &b.after, &b.after_error});
}

void round_off(Detectable& effect) {
  round_off(effect.smallest);
  round_off({&effect.typical});
}

void round_off(PathTrace& path) {
  for (auto& point : path.points) round_each(point);
}

void round_off(ScanTrace& scan) {
  round_each(scan.before);
  round_each(scan.after);
  for (auto& point : scan.points)
    for (double& value : point) value = millimetres(value);
}

void round_off(ResidualAxis& axis) {
  round_off({&axis.mean, &axis.std, &axis.normalised, &axis.autocorrelation, &axis.runs, &axis.reference_std,
             &axis.wheels_std});
}

void round_off(ResidualSample& sample) {
  round_off({&sample.t});
  round_each(sample.sigmas);
}

template <typename T>
std::vector<T> rounded(std::vector<T> items) {
  for (T& item : items) round_off(item);
  return items;
}

}  // namespace

void store_report_data(const ReportData& data, Calibration& calibration) {
  calibration.drive_errors = rounded(data.drive_errors);
  if (!data.detectable.empty()) calibration.detectable = rounded(data.detectable);
  Picture& picture = calibration.picture.emplace();
  picture.growth = rounded(data.growth);
  picture.paths = rounded(data.paths);
  picture.scans = rounded(data.scans);
  picture.traces = rounded(data.traces);
  picture.axes = rounded(data.axes);
  picture.series = rounded(data.series);
  picture.left_out = data.left_out;
  for (auto& [name, values] : picture.left_out) round_each(values);
}

ReportData report_data_of(const Calibration& calibration) {
  ReportData data;
  if (calibration.picture) static_cast<Picture&>(data) = *calibration.picture;
  if (calibration.drive_errors) data.drive_errors = *calibration.drive_errors;
  data.detectable = calibration.detectable;
  return data;
}

}  // namespace odomcalib
