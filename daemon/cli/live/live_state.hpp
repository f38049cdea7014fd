// Content of the page of `odomcalibctl view`, gathered from what the daemon answers and publishes.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/math/se2.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

using calib::math::Pose;

/// Shows poses of a source whose own frame begins anywhere: the first pose after a restart continues where
/// the path ends, in the direction that it has there.
class Trace {
 public:
  static constexpr std::size_t kMostPoints = settings::kMostPoints;
  static constexpr double kSpacing =
      settings::kSpacing_m;  ///< between points, doubled when there are too many

  /// @param points m, rad; what is shown from now on. Empty: nothing, until poses arrive at the origin.
  void restart(const std::vector<Pose>& points);
  /// The robot rests here, in the source's frame: the frame continues from this pose, not from the next one.
  void continue_from(const Pose& source);
  void add(const Pose& source);

  [[nodiscard]] const std::vector<Pose>& points() const { return points_; }
  /// Where the source is now, in the frame that is shown; nullopt before its first pose.
  [[nodiscard]] const std::optional<Pose>& now() const { return now_; }

 private:
  void append(const Pose& shown);

  std::vector<Pose> points_;
  std::optional<Pose> now_;
  std::optional<Pose> from_source_;  ///< to what is shown
  double spacing_ = kSpacing;
};

/// Values in, one JSON document out (docs/schema/view-1.json), of bounded size whatever came in. All paths
/// begin at one pose, where the last drive began; there is no other frame that odometry, calibrated odometry
/// and scans share.
class LiveState {
 public:
  static constexpr std::size_t kMostBeams = settings::kMostBeams;

  /// @param description answer of Describe. @param lcm_opened whether its LCM URL could be opened
  void connect(const nlohmann::ordered_json& description, bool lcm_opened);
  void disconnect(const std::string& why);
  void take_status(const nlohmann::ordered_json& status);
  /// Whether scans have to be asked for: no LCM message brings them.
  [[nodiscard]] bool needs_scan() const;
  /// @param scan answer of GetScan
  void take_scan_answer(const nlohmann::ordered_json& scan);
  void take_parameters(const nlohmann::ordered_json& parameters);
  /// @param channel without prefix. Bytes that are no message of this channel change nothing.
  void take_message(std::string_view channel, std::string_view bytes);

  [[nodiscard]] nlohmann::ordered_json document() const;

 private:
  void take_odometry(const Pose& pose);
  void take_progress(std::string_view bytes);
  void take_scan(std::string_view bytes);
  void take_result(std::string_view bytes);
  void begin_drive();
  [[nodiscard]] std::string why_no_telemetry() const;
  [[nodiscard]] Pose lidar_pose() const;
  [[nodiscard]] nlohmann::ordered_json all_rows() const;
  /// With what each is known to: by the last solve, or what the motion recorded so far would give.
  [[nodiscard]] nlohmann::ordered_json parameter_rows() const;

  bool connected_ = false, drives_ = false, lcm_opened_ = false;
  std::string problem_ = "not asked yet", lcm_url_;
  int answers_without_message_ = 0;
  nlohmann::ordered_json status_ = nlohmann::ordered_json::object();
  nlohmann::ordered_json parameters_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json progress_;  ///< null: none
  Pose nominal_lidar_;
  Trace odometry_, calibrated_;
  std::optional<Pose> last_odometry_, last_calibrated_;  ///< in the frames of their sources
  std::vector<Pose> reference_;
  std::vector<std::array<double, 2>> scan_;       ///< m, frame of the lidar
  std::vector<std::array<double, 2>> base_scan_;  ///< of a scan that was asked for: m, frame of the base
  std::optional<Calibration> result_;
};

}  // namespace odomcalib::cli
