// Data of a report beyond the contract of the calibration file: errors that a user feels, and the points of
// its pictures. Additive members `drive_errors`, `detectable` and `picture` of the file.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace odomcalib {

/// A figure with its 95 % interval.
struct Bounded {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Error of dead reckoning against the reference over one kind of motion, on data not used in the fit.
struct DriveError {
  std::string name;               ///< straight_metre_length, full_turn_heading, ...
  std::string unit;               ///< m or rad
  std::size_t stretches = 0;      ///< of motion that the figures stand on
  std::optional<Bounded> before;  ///< with the nominal values
  std::optional<Bounded>
      geometry;  ///< with wheels and track width corrected, no effects; absent without effects
  std::optional<Bounded> after;       ///< with everything that was found
  std::optional<double> noise_floor;  ///< what noise of reference and wheels alone would show
};

/// Error of the position of dead reckoning after a way, on data not used in the fit: RMS over stretches, m.
struct ErrorGrowth {
  double way = 0.0;  ///< m driven, the mean of the stretches
  std::size_t stretches = 0;
  std::optional<double> before, geometry, after;  ///< as in DriveError
};

/// Residual of single measured motions with and without one effect, by the variable that the effect acts by.
struct ResidualTrace {
  struct Point {
    double variable = 0.0, before = 0.0, after = 0.0;
  };
  /// Means of neighbouring points; errors are half widths of 95 % intervals.
  struct Bin {
    double variable = 0.0, before = 0.0, before_error = 0.0, after = 0.0, after_error = 0.0;
  };
  std::string effect;  ///< name, or "curve of ... on ..."
  std::string variable, variable_unit;
  std::string residual, residual_unit;  ///< forward, sideways or heading; m, rad, m/m, ...
  double explained = 0.0;  ///< share of the effect's own pattern that a function of the variable describes
  std::vector<Point> points;
  std::vector<Bin> bins;
};

/// An effect that was not found, and what size it would have been found at.
struct Detectable {
  std::string effect, parameter, unit;
  std::optional<double> smallest;  ///< absent where no size shows: other parameters take all of it
  double typical = 0.0;            ///< what robots have; where the smallest is larger, this drive was no test
  std::string motion;              ///< that shows it
};

struct PathTrace {
  std::string name;                           ///< odometry (nominal values), calibrated, reference
  std::vector<std::array<double, 3>> points;  ///< x, y, yaw: m, m, rad, frame of the base at the start
};

/// One scan, and from where odometry says that it was taken on a stretch that was not fitted.
struct ScanTrace {
  std::vector<std::array<double, 2>> points;  ///< m, in the frame of the base
  std::array<double, 3> before{}, after{};    ///< x, y, yaw of the base since the begin: m, m, rad
};

/// Residual of the final model in one axis of the sensor.
struct ResidualAxis {
  std::string name, unit;
  double mean = 0.0, std = 0.0;        ///< in the unit; outliers weigh less
  double normalised = 0.0;             ///< standard deviation in units of the expected one
  double autocorrelation = 0.0;        ///< of neighbours, normalised residual
  double runs = 0.0;                   ///< runs test: standard normal when the order is random
  std::vector<std::size_t> histogram;  ///< of the normalised residual, equal bins over -5 to 5
  /// Standard deviations that a pair is weighed with, the median of the trusted ones, in the unit: of the
  /// measurement by scans or poses, and of the wheels and the floor; NaN where the file does not say.
  double reference_std = std::numeric_limits<double>::quiet_NaN();
  double wheels_std = std::numeric_limits<double>::quiet_NaN();
};

struct ResidualSample {
  double t = 0.0;                  ///< s
  std::array<double, 3> sigmas{};  ///< normalised x, y, yaw
};

/// Points of the figures: most of a file's bytes, and nothing that odometry needs.
struct Picture {
  std::vector<ErrorGrowth> growth;
  std::vector<PathTrace> paths;
  std::vector<ScanTrace> scans;
  std::vector<ResidualTrace> traces;
  std::vector<ResidualAxis> axes;
  std::vector<ResidualSample> series;
  /// Each parameter fitted without one fifth of the data, five times.
  std::vector<std::pair<std::string, std::vector<double>>> left_out;
};

struct ReportData : Picture {
  std::vector<DriveError> drive_errors;
  std::vector<Detectable> detectable;
};

/// Name of the points in the file, for those who pass a file on without them.
inline constexpr const char* kPictureMember = "picture";

struct Calibration;
/// Puts the data into the calibration, rounded to what a picture can show.
void store_report_data(const ReportData& data, Calibration& calibration);
/// The report data of a calibration; members that are absent are empty.
ReportData report_data_of(const Calibration& calibration);

}  // namespace odomcalib
