// The calibration file (JSON, format "odomcalib-calibration/1").
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/base_quantities.hpp"
#include "proto/calibration/members.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/discarded.hpp"
#include "proto/measurements.hpp"
#include "proto/middleware.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Estimate of one quantity; std < 0 means "not estimated", written as null.
struct Quantity {
  double value = 0.0;
  double std = -1.0;
  std::string unit;
};

/// Ordered, because the file and every table show quantities in a fixed order.
using QuantityList = std::vector<std::pair<std::string, Quantity>>;

/// When the robot was driven: first and last sample, in s since 1970, UTC.
struct Driven {
  double begin = 0.0, end = 0.0;
};

struct LinearCorrection {
  std::array<std::array<double, 3>, 3> matrix{};
  double condition = 0.0;       ///< condition number of A^T A
  std::array<double, 3> rms{};  ///< m, m, rad
};

/// Result of one of the estimators, or the reason why it refused.
struct MethodResult {
  std::string name;  ///< straight, spin, linear, joint_closed_form, joint
  std::optional<std::string> refused;
  QuantityList parameters;
  std::array<double, 3> rms{};  ///< m, m, rad
  std::size_t used = 0;
  std::size_t discarded = 0;
};

struct Evidence {
  double p_value = 1.0;
  std::optional<double> held_out_before;  ///< open-loop odometry error at the horizon, m
  std::optional<double> held_out_after;
};

struct EffectResult {
  std::string name;
  QuantityList parameters;
  Evidence evidence;
  std::vector<std::string> aliases;
  std::string stored_in = "host";  ///< "controller" or "host"
};

struct Unexplained {
  std::vector<std::string> depends_on;
  double p_value = 1.0;
  double share = 0.0;  ///< share of the residual's systematic part
};

/// RMS in m, m, rad; absent when it could not be measured on held-out data.
struct ResidualReport {
  bool held_out = true;
  std::optional<std::array<double, 3>> before, after, noise_floor;
};

struct DataUse {
  std::string name;
  std::string sha256;
  std::optional<double> begin;                                 ///< s, stamp of the first ticks
  double duration = 0.0;                                       ///< s
  std::vector<std::pair<std::string, std::size_t>> counts;     ///< e.g. ticks, scans, pairs
  std::vector<std::pair<std::string, std::size_t>> discarded;  ///< reason -> count
  std::vector<std::string> choices;  ///< what was taken where the file held several, e.g. topics
  Middleware middleware = Middleware::none;
};

/// Members that this program does not know, or not in this shape, as a newer one writes them: JSON text by
/// the path of their object ("" is the file) and their name. They are kept when a file is read and written
/// again.
using UnknownMembers = std::map<std::string, std::map<std::string, std::string>>;

enum class Verdict { accepted, accepted_with_warnings, refused };
/// As files and JSON have it.
constexpr const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::accepted:
      return "accepted";
    case Verdict::accepted_with_warnings:
      return "accepted_with_warnings";
    case Verdict::refused:
      break;
  }
  return "refused";
}

struct Calibration {
  RobotDescription robot;        ///< nominal values used
  std::optional<Driven> driven;  ///< none where no recording has a clock that tells the date
  QuantityList
      parameters;  ///< left_wheel_diameter, right_wheel_diameter, track_width, lidar_x, lidar_y, lidar_yaw
  std::vector<std::string> covariance_order;
  std::vector<std::vector<double>> covariance;  ///< SI units, row-major, order above
  std::optional<LinearCorrection> linear_correction;
  std::vector<MethodResult> methods;
  std::vector<EffectResult> effects;
  std::optional<Unexplained> unexplained;
  ResidualReport residual;
  Verdict verdict = Verdict::refused;
  std::vector<std::string> reasons = {"solve was not called"};
  std::string next_step;  ///< by the weightiest reason, without a full stop; empty where there is none
  std::vector<DataUse> data;
  /// Whatever was left out before and in the fit, and what was put right or chosen. Of several recordings the
  /// reasons begin with the name of the file.
  std::vector<Discarded> discarded;
  std::vector<Repair> repairs;

  // Members that came after the first version of the format, by their names in the file. What is not set is
  // not written.
  std::vector<ConsideredTerm> considered;
  std::optional<ContactNoise> contact_noise;
  std::vector<SmoothTermEntry> curves;
  std::vector<Detectable> detectable;
  std::optional<std::vector<DriveError>> drive_errors;
  std::vector<GyroResult> gyros;
  std::optional<HomogeneityTest> homogeneity;
  std::vector<LidarCurve> lidar_curves;
  std::optional<double> odometer;  ///< m, what the robot's own counter of distance said
  std::optional<OutlierReport> outliers;
  std::optional<Picture> picture;
  std::optional<ProofEntry> proof;
  std::optional<ProposalEntry> proposal;
  std::vector<RecordingAlone> recordings;
  std::optional<Scale> scale;
  std::optional<SolveSettings> settings;
  std::optional<StampTimes> stamps;

  UnknownMembers unknown;

  /// Value of a top-level parameter, or nullopt.
  [[nodiscard]] std::optional<double> parameter(const std::string& name) const {
    for (const auto& [key, quantity] : parameters)
      if (key == name) return quantity.value;
    return std::nullopt;
  }
  [[nodiscard]] std::optional<double> parameter(BaseQuantity quantity) const {
    return parameter(std::string(name_of(quantity)));
  }
};

/// Path of the first parameter, of the robot or of an effect, whose value is no finite number (null in the
/// file), e.g. "parameters.track_width": with it nothing may be computed or written elsewhere.
std::optional<std::string> non_finite_value(const Calibration& calibration);

/// JSON text with two-space indent and a fixed member order (same input, same bytes). Non-finite numbers
/// become null.
std::string to_json(const Calibration& calibration);
/// Members of the file that other documents have, too.
nlohmann::ordered_json to_json(const SolveSettings& settings);
nlohmann::ordered_json to_json(const ProposalEntry& proposal);
/// Beginning of the error about a file in a version of the format that this program does not read.
inline constexpr const char* kOtherVersion =
    "is a calibration file of a version that this program does not read";
Result<Calibration> calibration_from_json(const std::string& text, const std::string& where);
/// The same of a value that was parsed already, as in a call of the control interface: nesting is not
/// limited, whoever parsed it has done that.
Result<Calibration> calibration_from(const nlohmann::ordered_json& value, const std::string& where);
Result<Calibration> read_calibration(const std::filesystem::path& path);
/// Writes to a temporary file, syncs and renames: the old file stays whole until the new one is.
Result<void> write_calibration(const Calibration& calibration, const std::filesystem::path& path);

}  // namespace odomcalib
