// Calibration files against each other: grouped by robot and brought into order; what is computed of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/comparison/difference.hpp"
#include "calib/comparison/trend.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

inline constexpr double kDay_s = 86'400.0;

struct ComparedFile {
  std::string path;
  Calibration calibration;
  std::string left_out = {};  ///< why it is not compared; empty: it is
};

/// Over what values are drawn.
struct TrendAxis {
  enum class Kind { date, distance, number };
  Kind kind = Kind::number;
  double zero = 0.0;      ///< s since 1970, of a date
  std::vector<double> x;  ///< days since then; m; calibrations from 1 on
};

struct TrendOverAxis {
  TrendAxis axis;
  std::vector<calib::comparison::ParameterTrend> parameters;
};

struct ComparedRobot {
  std::string robot_id;  ///< empty: no file names it
  bool by_date = false;  ///< in order of dates; otherwise as the files were named
  std::vector<ComparedFile> files;
  std::vector<std::size_t> usable;                       ///< which of the files are not left out
  std::vector<calib::comparison::Difference> steps;      ///< from each usable one to the next
  std::optional<calib::comparison::Difference> overall;  ///< from the first to the last, of more than two
  calib::comparison::JointTest all;                      ///< nothing changed in any
  std::vector<TrendOverAxis> trends;
  calib::comparison::RobotStanding standing;

  [[nodiscard]] const ComparedFile& usable_file(std::size_t k) const { return files[usable[k]]; }
};

struct ComparisonOptions {
  bool by_robot = false, trend = false;
  std::optional<double> bound;  ///< m in a metre, that the error of a metre must not pass
};

/// Without its folder.
std::string file_name(const std::string& path);

/// "5mm/m" or "0.5%", as m in a metre. Error: usage.
Result<double> error_of_metre_from_text(const std::string& text);

/// Groups in the order of how urgent they are.
/// Errors: usage (without by_robot: files of two robots, a single file, two of one recording, or files
/// without a value in common), refused (of a robot that was named alone fewer than two were not refused).
Result<std::vector<ComparedRobot>> compare(std::vector<ComparedFile> files, const ComparisonOptions& options);

}  // namespace odomcalib::cli
