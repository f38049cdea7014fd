#include "daemon/writeback/drive_proof.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "daemon/writeback/settings.hpp"
#include "proto/angles.hpp"
#include "proto/calibration/field_list.hpp"

namespace odomcalib {
namespace {

using nlohmann::ordered_json;
namespace settings = writeback::settings;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// @param words, noise, factor, unit see DriveFigure
template <std::size_t Index>
constexpr DriveFigure figure_of(const char* words, double noise, double factor, const char* unit) {
  constexpr auto kMember = std::get<Index>(fields::Members<DriveErrors>::list());
  return {kMember.key, words, kMember.member, noise, factor, unit};
}

/// In the order of the list of members.
constexpr std::array kDriveFigures = {
    figure_of<0>("straight metre: length", settings::kLengthNoise_m, 1e3, "mm"),
    figure_of<1>("straight metre: heading", settings::kHeadingNoise_rad, kDegrees, "deg"),
    figure_of<2>("full turn: heading", settings::kHeadingNoise_rad, kDegrees, "deg")};
static_assert(kDriveFigures.size() == std::tuple_size_v<decltype(fields::Members<DriveErrors>::list())>);

/// A move from rest to rest.
struct DrivenMove {
  double distance_error, yaw_error;  ///< m, rad
  double distance, yaw;              ///< m, rad, by the lidar
};

std::optional<DrivenMove> driven_move(const ordered_json& body) {
  const ordered_json& error = body.value("error", ordered_json());
  const ordered_json& lidar = body.value("lidar", ordered_json());
  if (!error.is_object() || !lidar.is_array() || lidar.size() != 3) return std::nullopt;
  const DrivenMove move{error.value("distance", kNotMeasured), error.value("yaw", kNotMeasured),
                        std::hypot(lidar[0].get<double>(), lidar[1].get<double>()),
                        std::abs(lidar[2].get<double>())};
  const bool known = std::isfinite(move.distance_error + move.yaw_error + move.distance + move.yaw);
  return known ? std::optional(move) : std::nullopt;
}

/// Empty: one of them was not seen.
std::vector<DrivenMove> driven_moves(const ordered_json& motion) {
  std::vector<DrivenMove> moves;
  for (const auto& body : motion.value("moves", ordered_json::array())) {
    const auto move = driven_move(body);
    if (!move) return {};
    moves.push_back(*move);
  }
  return moves;
}

/// Root mean square of `error(move)`.
template <typename ErrorOf>
double mean_error(const std::vector<DrivenMove>& moves, ErrorOf error) {
  double sum = 0.0;
  for (const DrivenMove& move : moves) sum += std::pow(error(move), 2);
  return std::sqrt(sum / static_cast<double>(moves.size()));
}

bool straight_on(const DrivenMove& move) { return move.distance >= settings::kLeastProofWay_m; }
bool on_the_spot(const DrivenMove& move) {
  return !straight_on(move) && move.yaw >= settings::kLeastProofTurn_rad;
}

Error unproven(const std::string& what) {
  return {ErrorCode::refused, "nothing was stored: " + what, "proof run",
          "drive a straight metre and a full turn with the old values and with the new ones, where the lidar "
          "sees walls; or take them back: odomcalibctl rollback"};
}

}  // namespace

std::span<const DriveFigure> drive_figures() { return kDriveFigures; }

bool DrivenErrors::add(const ordered_json& motion) {
  const std::vector<DrivenMove> moves = driven_moves(motion);
  if (moves.empty()) return false;
  if (std::all_of(moves.begin(), moves.end(), straight_on)) {
    errors_.straight_metre_length =
        mean_error(moves, [](const auto& move) { return move.distance_error / move.distance; });
    errors_.straight_metre_heading =
        mean_error(moves, [](const auto& move) { return move.yaw_error / move.distance; });
    return straight_ = true;
  }
  if (!std::all_of(moves.begin(), moves.end(), on_the_spot)) return false;
  errors_.full_turn_heading =
      mean_error(moves, [](const auto& move) { return 2.0 * std::numbers::pi * move.yaw_error / move.yaw; });
  return turn_ = true;
}

std::optional<DriveErrors> DrivenErrors::all() const {
  return straight_ && turn_ ? std::optional(errors_) : std::nullopt;
}

std::optional<std::string> worse(const DriveErrors& before, const DriveErrors& after) {
  for (const DriveFigure& one : kDriveFigures) {
    const double was = before.*one.value, is = after.*one.value;
    if (is <= std::max(was, one.noise)) continue;
    return fmt::format("{} is off by {:.2f} {} with the new values, by {:.2f} {} with the old ones",
                       one.words, one.factor * is, one.unit, one.factor * was, one.unit);
  }
  return std::nullopt;
}

void DriveProof::other_values() { before_ = std::exchange(now_, {}); }

void DriveProof::taken_back() {
  if (before_) now_ = *std::exchange(before_, std::nullopt);
}

void DriveProof::committed() {
  if (!before_) now_ = {};
  before_.reset();
}

void DriveProof::forget() {
  now_ = {};
  before_.reset();
}

std::optional<Error> DriveProof::lacking() const {
  const auto after = now_.all();
  if (!after)
    return unproven("no straight line and turn on the spot that the lidar saw were driven with these values");
  const auto before = before_ ? before_->all() : std::nullopt;
  if (!before) return unproven("what odometry was off by with the old values was not measured");
  const auto what = worse(*before, *after);
  return what ? std::optional(unproven(*what)) : std::nullopt;
}

DriveTrial DriveProof::trial() const {
  return before_ ? DriveTrial{before_->all(), now_.all()} : DriveTrial{};
}

}  // namespace odomcalib
