#include "calib/report/verdict_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/classical/length_factor.hpp"
#include "calib/classical/settings.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/settings.hpp"
#include "calib/report/settings.hpp"
#include "calib/validation/drive_error.hpp"
#include "calib/validation/settings.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::calib::report {
namespace {

using Objections = std::vector<Objection>;

Objection refusal(const std::string& reason, const std::string& next = {}) {
  return {true, reason, 0.0, false, next};
}
Objection warning(const std::string& reason, const std::string& next = {}) {
  return {false, reason, 0.0, false, next};
}
/// @param weight times the limit of the rule
Objection sign(const std::string& reason, double weight, const std::string& next = {}) {
  return {false, reason, weight, false, next};
}

std::string percent(double share) { return math::significant(100.0 * share, 3) + " %"; }

std::string times(double ratio) { return math::fixed(ratio, 1) + " times"; }

// --- What odometry is off by -------------------------------------------------------------------------------

struct DriveFigure {
  const char* name;
  const char* words;
  double largest;  ///< m or rad, of odometry that is not off
};

constexpr std::array kDriveFigures = {
    DriveFigure{"straight_metre_length", "the length of a straight metre", settings::kMetreOff_m},
    DriveFigure{"straight_metre_heading", "the heading over a straight metre", settings::kMetreOff_rad},
    DriveFigure{"full_turn_heading", "the heading over a full turn", settings::kTurnOff_rad}};

const DriveError* error_of(const VerdictEvidence& evidence, const char* name) {
  for (const DriveError& error : evidence.drive_errors)
    if (error.name == name) return &error;
  return nullptr;
}

std::string amount(const DriveError& error, double value) {
  return error.unit == "rad" ? math::degrees_text(value) : math::millimetres_text(value);
}

/// The nominal values leave more than noise.
bool could_gain(const DriveError& error) {
  return error.before && error.after && error.noise_floor &&
         error.before->value > settings::kWorthGaining * *error.noise_floor;
}

bool is_no_better(const DriveError& error) {
  return could_gain(error) && error.after->value >= settings::kNoBetter * error.before->value;
}

/// None of the figures that were off came nearer to the truth.
bool is_nothing_gained(const std::vector<DriveError>& errors) {
  return std::none_of(errors.begin(), errors.end(),
                      [](const DriveError& error) { return could_gain(error) && !is_no_better(error); });
}

Objections no_better_than_before(const Calibration&, const VerdictEvidence& evidence) {
  const bool refuses = is_nothing_gained(evidence.drive_errors);
  Objections found;
  for (const DriveError& error : evidence.drive_errors) {
    const auto words = std::find_if(kDriveFigures.begin(), kDriveFigures.end(),
                                    [&](const DriveFigure& figure) { return figure.name == error.name; });
    if (!is_no_better(error)) continue;
    found.push_back(
        {refuses,
         (words == kDriveFigures.end() ? "odometry over ten seconds" : std::string(words->words)) +
             " is no better than before on data that was not fitted: off by " +
             amount(error, error.before->value) + " with the nominal values, by " +
             amount(error, error.after->value) + " now" +
             (refuses ? "; nothing that was off is better: keep the old values" : ""),
         error.after->value / (settings::kNoBetter * error.before->value)});
  }
  return found;
}

/// Poses that were computed of the wheels agree with these to rounding, whatever values they were computed
/// with. Counts have steps, which anything else that measures is off by.
Objections poses_of_wheels(const Calibration& calibration, const VerdictEvidence& evidence) {
  const DriveError* error = validation::open_loop_position(evidence.drive_errors);
  if (!evidence.of_poses || error == nullptr || !error->after) return {};
  const RobotDescription& robot = calibration.robot;
  const bool is_counted = evidence.motion == MotionSource::ticks && robot.ticks_per_rev > 0.0;
  const double step = is_counted ? math::kPi * robot.left_wheel_diameter / robot.ticks_per_rev : 0.0;
  const double limit = std::max(settings::kShareOfStep * step, settings::kRounding_m);
  if (!(error->after->value < limit)) return {};
  const std::string reason =
      "the poses agree with the wheels to " + math::millimetres_text(error->after->value) +
      " over ten seconds, as only poses do that are computed of the wheels (odometry): they show nothing of "
      "the robot; record poses that something else measures, or leave them out where there are scans";
  return {is_counted ? refusal(reason) : warning(reason)};
}

Objections still_off(const Calibration&, const VerdictEvidence& evidence) {
  Objections found;
  for (const DriveFigure& figure : kDriveFigures) {
    const DriveError* error = error_of(evidence, figure.name);
    if (error == nullptr || !error->after || !(error->after->low > figure.largest)) continue;
    found.push_back(sign(std::string(figure.words) + " is still off by " +
                             amount(*error, error->after->value) +
                             " on data that was not fitted: look for slip, loose wheels and what moves the "
                             "lidar before this is relied on",
                         error->after->low / figure.largest));
  }
  return found;
}

/// The error over ten seconds where it is more than noise explains; null otherwise.
const DriveError* excessive(const std::vector<DriveError>& errors) {
  const DriveError* error = validation::open_loop_position(errors);
  if (error == nullptr || !error->after || !error->noise_floor) return nullptr;
  const double floor = *error->noise_floor;
  return error->after->value > settings::kWarnResidual * floor && error->after->low > floor ? error : nullptr;
}

/// Lost counts or slip now and then leave most pairs clean, and add up on the way.
Objections odometry_off(const Calibration&, const VerdictEvidence& evidence) {
  const DriveError* error = excessive(evidence.drive_errors);
  if (error == nullptr) return {};
  const double ratio = error->after->value / *error->noise_floor;
  return {sign("odometry over ten seconds is off by " + times(ratio) +
                   " the noise floor: something moves the robot that the counts do not show; look for counts "
                   "that get lost, slip, and what touches the robot",
               ratio / settings::kWarnResidual)};
}

constexpr const char* kWalls = "drive where the lidar sees walls on all sides";
constexpr const char* kReadings =
    "drive nearer to walls, and check what covers the lidar, range_min and range_max, and whether its driver "
    "leaves readings out";
constexpr const char* kBearings =
    "check angle_min, angle_increment and the number of beams against the lidar's data sheet, and drive "
    "where it sees walls on all sides";

// --- Matches ---------------------------------------------------------------------------------------------

double share_of_matches(const VerdictEvidence& evidence) {
  const auto all = static_cast<double>(evidence.matched + evidence.unmatched + evidence.stood);
  return all > 0.0 ? static_cast<double>(evidence.matched) / all : 1.0;
}

bool are_in_part(const VerdictEvidence& evidence) { return 2 * evidence.partial > evidence.matched; }

/// The rest may say something else.
bool has_few_matches(const VerdictEvidence& evidence) {
  return share_of_matches(evidence) <
         (are_in_part(evidence) ? settings::kFewestMatchedInPart : settings::kFewestMatched);
}

/// ", with 17 of 361 readings a scan" where so many beams met nothing that it matters; else nothing.
std::string few_readings(std::size_t readings, std::size_t beams) {
  if (!(static_cast<double>(readings) < settings::kFewReadings * static_cast<double>(beams))) return "";
  return ", with " + std::to_string(readings) + " of " + std::to_string(beams) + " readings a scan";
}

/// Walls are found among readings beside each other.
bool are_too_thin(const VerdictEvidence& evidence) {
  return evidence.too_thin > 0 && 2 * evidence.too_thin > evidence.unmatched;
}

std::string readings_text(const VerdictEvidence& evidence) {
  if (!are_too_thin(evidence)) return few_readings(evidence.readings, evidence.beams);
  return ", with " + std::to_string(evidence.readings) + " of " + std::to_string(evidence.beams) +
         " readings a scan: too few beside each other for a wall";
}

/// Nothing where there are none.
std::string while_it_stood(std::size_t pairs) {
  if (pairs == 0) return "";
  return ", and in " + std::to_string(pairs) +
         " the wheels turned and the scans show a robot that stood: it pushed against something, what the "
         "lidar "
         "sees moves along with it, or scans came twice";
}

std::string matches_text(const VerdictEvidence& evidence) {
  const std::string some = evidence.matched == 0 ? "none" : "only " + std::to_string(evidence.matched);
  return some + " of " + std::to_string(evidence.matched + evidence.unmatched + evidence.stood) +
         " pairs of scans could be matched" + readings_text(evidence) + while_it_stood(evidence.stood);
}

std::string parts_text(const VerdictEvidence& evidence) {
  return std::to_string(evidence.partial) + " of " + std::to_string(evidence.matched) +
         " pairs of scans leave one direction open" + few_readings(evidence.readings, evidence.beams) +
         while_it_stood(evidence.stood);
}

// --- Lengths ---------------------------------------------------------------------------------------------

struct Length {
  BaseQuantity id = BaseQuantity::track_width;
  std::string name;
  Quantity quantity;
  double nominal = 0.0;
  double measured = 0.0;  ///< relative deviation that the motion leaves
  [[nodiscard]] double relative() const { return quantity.std / std::abs(quantity.value); }
  [[nodiscard]] bool is_determined() const {
    return quantity.std >= 0.0 && !(measured > settings::kMaxRelativeDeviation);
  }
  [[nodiscard]] bool is_positive() const { return std::isfinite(quantity.value) && quantity.value > 0.0; }
};

std::optional<double> relative_deviation(const QuantityList& quantities, const std::string& name) {
  for (const auto& [own, quantity] : quantities)
    if (own == name) return quantity.std / std::abs(quantity.value);
  return std::nullopt;
}

std::vector<Length> lengths_of(const Calibration& calibration, const VerdictEvidence& evidence) {
  std::vector<Length> lengths;
  for (const auto& [name, quantity] : calibration.parameters) {
    const auto id = base_quantity_from(name);
    if (!id || !is_drive_length(*id)) continue;
    Length length{*id, name, quantity, nominal_value(calibration.robot, *id).value_or(0.0)};
    length.measured = relative_deviation(evidence.measured, name).value_or(length.relative());
    lengths.push_back(length);
  }
  return lengths;
}

constexpr const char* kCorrect =
    "correct robot.toml, or the recording, as the first reason says, and solve again";

std::string motion_for(BaseQuantity length, const VerdictEvidence& evidence) {
  if (evidence.missing_motion) return *evidence.missing_motion;
  return length == BaseQuantity::track_width ? "more turns on the spot, both ways"
                                             : "longer straight lines, forward and backward";
}

/// The remedy for a length that is not known, and the cause where the scans show it.
std::pair<std::string, std::string> remedy_and_cause(BaseQuantity length, const VerdictEvidence& evidence) {
  if (are_in_part(evidence)) return {kWalls, parts_text(evidence)};
  if (share_of_matches(evidence) < settings::kWarnMatched)
    return {remedy_for_readings(evidence).value_or(kBearings), matches_text(evidence)};
  return {"record " + motion_for(length, evidence), ""};
}

/// A finding from few pairs may as well be a few failed matches.
bool names_no_cause(const VerdictEvidence& evidence) {
  return evidence.pairs > 0 && static_cast<double>(evidence.pairs) < settings::kFewestForCause;
}

/// The value of a length that the motion does not determine says nothing.
Objections undetermined_lengths(const std::vector<Length>& lengths, const VerdictEvidence& evidence) {
  const auto open = [](const Length& length) { return !length.is_determined(); };
  if (names_no_cause(evidence) && std::all_of(lengths.begin(), lengths.end(), open))
    return {refusal("too short: " + std::to_string(evidence.pairs) +
                        " measured motions determine no length; record a minute or more, straight lines and "
                        "turns on the spot, both ways",
                    "record a minute or more, straight lines and turns on the spot, both ways")};
  Objections found;
  for (const Length& length : lengths) {
    if (length.is_determined()) continue;
    std::string reason = length.name + " " +
                         (length.measured < 1.0 ? "is determined to " + percent(length.measured) + " only"
                                                : std::string("is not determined"));
    const auto [remedy, cause] = remedy_and_cause(length.id, evidence);
    reason += "; to fix that, " + remedy + (cause.empty() ? "" : ": " + cause);
    found.push_back(refusal(reason, remedy + ", and solve again"));
  }
  return found;
}

std::string by_so_few(const VerdictEvidence& evidence) {
  std::string text = " by " + std::to_string(evidence.pairs) + " measured motions only, too few to say why";
  text += few_readings(evidence.readings, evidence.beams) + "; record longer";
  if (!evidence.of_poses) text += ", and drive where the lidar sees walls on all sides";
  return text;
}

/// The joint fit starts at the nominal heading of the lidar: of one that looks backwards all lengths are
/// negative.
Objections negative_lengths(const std::vector<Length>& lengths, const VerdictEvidence& evidence) {
  const auto negative = [](const Length& length) { return !length.is_positive(); };
  if (names_no_cause(evidence) && std::any_of(lengths.begin(), lengths.end(), negative))
    return {refusal("a length comes out as none" + by_so_few(evidence))};
  if (lengths.size() == 3 && std::all_of(lengths.begin(), lengths.end(), negative))
    return {
        refusal("the reference looks backwards by what lidar_pose says (by their yaw, of poses): all lengths "
                "come out negative, which half a turn puts right; correct that yaw by 3.14 rad, or, if it "
                "is right, the left and right counts are exchanged and both wheels count backwards")};
  Objections found;
  for (const Length& length : lengths)
    if (negative(length))
      found.push_back(refusal(
          length.name + " came out as a non-positive length: left and right wheels may be swapped, or "
                        "the lidar's direction of rotation is wrong",
          kCorrect));
  return found;
}

Objection objection_to(const classical::Cause& cause, bool refuses) {
  return {refuses, cause.what + "; " + cause.remedy, 0.0, false, kCorrect};
}

bool is_implausible(const Length& length) {
  const double ratio = length.quantity.value / length.nominal;
  return length.nominal > 0.0 && (ratio < settings::kPlausibleLow || ratio > settings::kPlausibleHigh);
}

/// One number that is wrong shows in several lengths.
std::optional<Objection> common_factor(const Calibration& calibration, const VerdictEvidence& evidence,
                                       const std::vector<Length>& lengths) {
  if (lengths.size() != 3 || !(calibration.robot.left_wheel_diameter > 0.0)) return std::nullopt;
  classical::LengthRatios ratios;
  for (const Length& length : lengths) {
    if (!length.is_determined() || !length.is_positive() || !(length.nominal > 0.0)) return std::nullopt;
    const double ratio = length.quantity.value / length.nominal;
    if (length.id == BaseQuantity::left_wheel_diameter)
      ratios.left = ratio;
    else if (length.id == BaseQuantity::right_wheel_diameter)
      ratios.right = ratio;
    else
      ratios.track = ratio;
  }
  const auto cause = cause_of_ratios(ratios, {calibration.robot, evidence.motion, evidence.of_poses});
  if (!cause) return std::nullopt;
  return objection_to(*cause, std::any_of(lengths.begin(), lengths.end(), is_implausible));
}

/// @param is_explained something was found beside the lengths, or has a variable
std::optional<Objection> objection_to_deviation(const Length& length, bool is_explained) {
  if (length.measured > settings::kWarnRelativeDeviation)
    return warning(length.name + " is determined to " + percent(length.measured) +
                       " only; a longer recording would help",
                   "record longer, and solve again");
  if (!(length.relative() > settings::kWarnRelativeDeviation)) return std::nullopt;
  if (!is_explained)
    return warning(length.name + " is known to " + percent(length.relative()) +
                       " only: something may act that data which were not fitted did not confirm",
                   "record longer, and solve again");
  return warning(length.name + " without what was found is known to " + percent(length.relative()) +
                     " only: how that goes on where it was not seen, this recording does not show",
                 "use the lengths for motion like the recorded one only");
}

std::optional<Objection> objection_to_change(const Length& length, const VerdictEvidence& evidence) {
  if (!(length.nominal > 0.0)) return std::nullopt;
  const double ratio = length.quantity.value / length.nominal;
  if (is_implausible(length) && names_no_cause(evidence))
    return refusal(length.name + " is " + percent(ratio) + " of its nominal value" + by_so_few(evidence));
  if (is_implausible(length))
    return refusal(length.name + " is " + percent(ratio) +
                       " of its nominal value: check ticks per revolution, gear ratio and units",
                   kCorrect);
  // However far: nominal values may be somebody's guess.
  if (std::abs(ratio - 1.0) > settings::kWarnChange)
    return sign(length.name + " differs from its nominal value by " + percent(ratio - 1.0), 1.0,
                "measure it with a tape: where that agrees, correct robot.toml; where not, look for slip");
  return std::nullopt;
}

/// In the order of the parameters: what a length is not, how well it is known, how far it is from nominal.
Objections lengths(const Calibration& calibration, const VerdictEvidence& evidence) {
  if (has_few_matches(evidence)) return {};  // which unmatched_pairs says
  const std::vector<Length> all = lengths_of(calibration, evidence);
  if (Objections found = undetermined_lengths(all, evidence); !found.empty()) return found;
  if (Objections found = negative_lengths(all, evidence); !found.empty()) return found;
  const auto factor = names_no_cause(evidence) ? std::nullopt : common_factor(calibration, evidence, all);
  Objections found;
  if (factor) found.push_back(*factor);
  const bool is_explained = !calibration.effects.empty() || calibration.unexplained;
  for (const Length& length : all) {
    if (const auto objection = objection_to_deviation(length, is_explained)) found.push_back(*objection);
    if (factor) continue;
    if (const auto objection = objection_to_change(length, evidence)) found.push_back(*objection);
  }
  return found;
}

/// Odometry whose yaw another sensor tells, and whose place is the way of the wheels along it, is wrong by
/// the scale of the wheels alone. Turned back into wheels, it shows nothing of their ratio and of the track
/// width.
Objections odometry_yaw(const Calibration& calibration, const VerdictEvidence& evidence) {
  if (evidence.motion != MotionSource::odometry) return {};
  double least = std::numeric_limits<double>::infinity(), most = -least, deviation = 0.0;
  for (const Length& length : lengths_of(calibration, evidence)) {
    if (!(length.nominal > 0.0)) return {};
    const double change = length.quantity.value / length.nominal - 1.0;
    least = std::min(least, change);
    most = std::max(most, change);
    deviation = std::max(deviation, length.measured);
  }
  const double factor = 0.5 * (least + most);
  if (!(std::abs(factor) > math::settings::kClearSigmas * deviation) ||
      !(most - least < settings::kOneFactor * std::abs(factor)))
    return {};
  return {warning(
      "both diameters and the track width change by one factor, " + math::fixed(100.0 * factor, 2) +
      " %, and the heading was right before: either the old values were calibrated against another "
      "metre, or yaw of the odometry is that of a gyro or a filter, which tells nothing of the track "
      "width and of the ratio of the wheels; record the odometry that the wheels alone make, or joint "
      "states")};
}

/// Both may be right: what is called front decides.
Objections lidar_yaw(const Calibration& calibration, const VerdictEvidence& evidence) {
  const auto yaw = calibration.parameter(BaseQuantity::lidar_yaw);
  if (!yaw || !calibration.robot.lidar_pose || names_no_cause(evidence)) return {};
  const double apart = math::wrap_angle(*yaw - (*calibration.robot.lidar_pose)[2]);
  if (!(std::abs(apart) > classical::settings::kFarYaw_rad)) return {};
  // Odometry that looks backwards has its sides exchanged: what it calls left is the right wheel.
  if (evidence.motion == MotionSource::odometry &&
      std::abs(apart) > math::kPi - classical::settings::kFarYaw_rad)
    return {refusal("the odometry looks backwards by what lidar_pose says, " +
                        math::fixed(std::abs(apart) * 180.0 / math::kPi, 0) +
                        " degrees: its frame is turned by half a turn, so that left and right are exchanged, "
                        "or yaw of lidar_pose is off by as much; turn the frame, or correct lidar_pose",
                    "turn the frame of the odometry by half a turn, or correct lidar_pose, and solve again")};
  return {warning("lidar_yaw differs from its nominal value by " + math::fixed(apart * 180.0 / math::kPi, 0) +
                  " degrees" + ": correct lidar_pose, or check which end of the robot counts forward")};
}

// --- Recordings --------------------------------------------------------------------------------------------

Objections recordings_disagree(const Calibration&, const VerdictEvidence& evidence) {
  if (!evidence.recordings_apart) return {};
  return {{evidence.recordings_apart->refuses, evidence.recordings_apart->reason}};
}

// --- Pairs -------------------------------------------------------------------------------------------------

Objections unmatched_pairs(const Calibration&, const VerdictEvidence& evidence) {
  const auto readings = remedy_for_readings(evidence);
  const std::string finding = matches_text(evidence) + "; " + readings.value_or(kWalls);
  const std::string step = readings ? *readings + ", and record again" : "";
  if (has_few_matches(evidence)) return {refusal(finding, step)};
  if (share_of_matches(evidence) < settings::kWarnMatched) return {warning(finding, step)};
  return {};
}

Objections contradicting_pairs(const Calibration&, const VerdictEvidence& evidence) {
  const double share =
      static_cast<double>(evidence.outliers) / static_cast<double>(std::max<std::size_t>(evidence.pairs, 1));
  if (!(share > settings::kManyContradict)) return {};
  const std::string finding = std::to_string(evidence.outliers) + " of " + std::to_string(evidence.pairs) +
                              " measured motions contradict what the others say of the wheels";
  if (!(share > settings::kTooManyContradict))
    return {{false, finding, share / settings::kManyContradict, true}};
  if (names_no_cause(evidence))
    return {refusal("motions contradict each other, " + std::to_string(evidence.outliers) +
                    " of them, measured" + by_so_few(evidence))};
  return {refusal(finding +
                  ": one set of lengths does not describe this robot; check counts that get lost, slip, and "
                  "time stamps, and record again")};
}

/// No rule on figures of held-out data could object. Of few pairs there is no residual, but errors of
/// odometry.
Objections untested(const Calibration& calibration, const VerdictEvidence& evidence) {
  if (calibration.residual.held_out || !evidence.drive_errors.empty()) return {};
  return {warning(
      "nothing of this drive was tested on data that was not fitted: that takes more than one block of " +
      math::fixed(validation::settings::kFoldBlock_s, 0) + " s, with motion in each")};
}

Objections residual_beyond_noise(const Calibration& calibration, const VerdictEvidence&) {
  const ResidualReport& residual = calibration.residual;
  if (!residual.after || !residual.noise_floor) return {};
  constexpr std::array kComponents = {"in x of the sensor", "in y of the sensor", "in yaw"};
  Objections found;
  for (std::size_t i = 0; i < kComponents.size(); ++i) {
    const double ratio = (*residual.after)[i] / (*residual.noise_floor)[i];
    if (ratio > settings::kWarnResidual)
      found.push_back(sign("the residual " + std::string(kComponents[i]) + " is " + times(ratio) +
                               " the noise floor: something was not found, and the stated deviations may be "
                               "too small",
                           ratio / settings::kWarnResidual));
  }
  return found;
}

// --- Agreement ---------------------------------------------------------------------------------------------

const MethodResult* method(const Calibration& calibration, const char* name) {
  for (const MethodResult& one : calibration.methods)
    if (one.name == name && !one.refused) return &one;
  return nullptr;
}

/// The closed form knows no effects: with some in the model both may be right.
Objections estimators_apart(const Calibration& calibration, const VerdictEvidence&) {
  const MethodResult* closed = method(calibration, "joint_closed_form");
  const MethodResult* joint = method(calibration, "joint");
  if (closed == nullptr || joint == nullptr || !calibration.effects.empty()) return {};
  Objections found;
  for (const auto& [name, ours] : joint->parameters)
    for (const auto& [other, theirs] : closed->parameters) {
      if (name != other || !is_drive_length(name)) continue;
      const double apart = theirs.value - ours.value, sigma = std::hypot(ours.std, theirs.std);
      const double by_sigma = std::abs(apart) / (settings::kEstimatorsApart * sigma),
                   by_share = std::abs(apart) / (settings::kEstimatorsApartShare * std::abs(ours.value));
      if (by_sigma > 1.0 && by_share > 1.0)
        found.push_back(sign("two estimators disagree on " + name + ": the closed form is " +
                                 percent(apart / ours.value) + " away, " +
                                 math::significant(std::abs(apart) / sigma, 3) +
                                 " of their common deviations; part of the recording says something else",
                             std::min(by_sigma, by_share)));
    }
  return found;
}

Objections residual_in_rows(const Calibration& calibration, const VerdictEvidence& evidence) {
  if (!calibration.effects.empty() || calibration.unexplained) return {};
  for (const ResidualAxis& axis : evidence.axes)
    if (axis.runs < settings::kTooFewRuns)
      return {warning("the residual in " + axis.name + " keeps its sign for long (runs test " +
                      math::significant(axis.runs, 3) +
                      "): something that was not found acts for a while; the stated deviations may be too "
                      "small")};
  return {};
}

/// The reader of the verdict sees that something is left without a name.
Objections something_unexplained(const Calibration& calibration, const VerdictEvidence&) {
  if (!calibration.unexplained) return {};
  std::string covariates;
  for (const std::string& one : calibration.unexplained->depends_on)
    covariates += (covariates.empty() ? "" : ", ") + one;
  const double share = calibration.unexplained->share;
  return {sign("part of the residual depends on " + covariates +
                   " and has no name: lengths hold for motion like the recorded one",
               share > settings::kMostUnexplained ? share / settings::kMostUnexplained : 0.0)};
}

Objections remarks(const Calibration&, const VerdictEvidence& evidence) {
  Objections found;
  for (const std::string& remark : evidence.remarks) found.push_back(warning(remark));
  return found;
}

Objections clock_put_right(const Calibration& calibration, const VerdictEvidence&) {
  Objections found;
  for (const Repair& repair : calibration.repairs)
    if (repair.what == kRepairedClock)
      found.push_back(warning(repair.reason + "; " + repair.chosen +
                              " was used: let nothing set a clock while recording"));
  return found;
}

Objections unsettled_fit(const Calibration&, const VerdictEvidence& evidence) {
  if (evidence.converged) return {};
  return {warning("the fit had not settled when its iterations ran out")};
}

/// Next to nothing is left out of a drive that is as it should be.
Objections much_left_out(const Calibration&, const VerdictEvidence& evidence) {
  Objections found;
  for (const Loss& loss : evidence.losses) {
    if (const auto refusing = too_much_left_out(loss))
      found.push_back(*refusing);
    else if (loss.share > settings::kWarnLeftOut)
      found.push_back(warning(loss.text + "; the lengths stand on the rest" +
                              (loss.of_wheels ? ", but odometry is off wherever this happens" : "")));
  }
  return found;
}

/// A sign without what to do about it.
std::string finding_of(const Objection& objection) {
  return objection.reason.substr(0, objection.reason.find_first_of(":;"));
}

/// The rules whose objections may be signs that the model is wrong.
constexpr std::array kSigns = {no_better_than_before, lengths,   contradicting_pairs, residual_beyond_noise,
                               odometry_off,          still_off, estimators_apart,    something_unexplained};

/// Each sign may have a harmless cause; many that are far beyond their limits have one in common.
Objections several_signs(const Calibration& calibration, const VerdictEvidence& evidence) {
  constexpr std::size_t kTold = 3;
  Objections signs;  // the weightiest of each rule
  double sum = 0.0;
  for (const auto& rule : kSigns) {
    const Objections found = rule(calibration, evidence);
    const auto most = std::max_element(found.begin(), found.end(),
                                       [](const auto& a, const auto& b) { return a.weight < b.weight; });
    if (most == found.end() || !(most->weight > 0.0)) continue;
    signs.push_back(*most);
    sum += std::min(most->weight, settings::kHeaviestSign);
  }
  if (!(sum > settings::kMostSigns)) return {};
  std::stable_sort(signs.begin(), signs.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  std::string weightiest;
  for (std::size_t k = 0; k < std::min(signs.size(), kTold); ++k)
    weightiest += (k > 0 ? "; " : "") + finding_of(signs[k]);
  return {
      refusal("several signs together say that two wheels on one axle and one clock do not describe this "
              "recording: " +
              weightiest +
              "; check that the counts are those of the two driven wheels, that all stamps are of one clock, "
              "and what slips or moves the lidar, and record again")};
}

constexpr std::array kRules = {
    VerdictRule{"much_left_out", kMendLosses, much_left_out},
    VerdictRule{"no_better_than_before", "keep the old values", no_better_than_before},
    VerdictRule{"poses_of_wheels", "record poses that something else measures, or scans, and solve again",
                poses_of_wheels},
    VerdictRule{"recordings_disagree",
                "solve recordings before and after a change of tyres, load or lidar separately",
                recordings_disagree},
    VerdictRule{"lengths", "record more of the motion that the reason names, and solve again", lengths},
    VerdictRule{"odometry_yaw",
                "record the odometry that the wheels alone make, or joint states, and solve again",
                odometry_yaw},
    VerdictRule{"lidar_yaw", "correct lidar_pose in robot.toml, and solve again", lidar_yaw},
    VerdictRule{"unmatched_pairs", "record where the lidar sees walls on all sides", unmatched_pairs},
    VerdictRule{"contradicting_pairs", "look for lost counts, slip and wrong time stamps, and record again",
                contradicting_pairs},
    VerdictRule{"untested", "drive longer, a minute or more, and solve again", untested},
    VerdictRule{"residual_beyond_noise", "record longer, with more kinds of motion", residual_beyond_noise},
    VerdictRule{"odometry_off", "look for lost counts, slip, and what touches the robot, and record again",
                odometry_off},
    VerdictRule{"still_off",
                "look for slip, loose wheels and a lidar that moves on its mount, and record again",
                still_off},
    VerdictRule{"estimators_apart", "look at \"Fitted without one fifth\" in the report", estimators_apart},
    VerdictRule{"residual_in_rows", "look for what acts for a while: heat, a loose part, a slope",
                residual_in_rows},
    VerdictRule{"something_unexplained", "use the lengths for motion like the recorded one only",
                something_unexplained},
    VerdictRule{"remarks", "read what the reasons say of the recording", remarks},
    VerdictRule{"clock_put_right", "let nothing set a clock while recording", clock_put_right},
    VerdictRule{"unsettled_fit", "record longer, with more kinds of motion", unsettled_fit},
    VerdictRule{"several_signs",
                "check which wheels are counted, the clocks, slip, and a lidar that moves, and record again",
                several_signs}};

}  // namespace

std::optional<std::string> poor_matches(const VerdictEvidence& evidence) {
  if (evidence.unmatched + evidence.stood > 0 && has_few_matches(evidence)) return matches_text(evidence);
  return are_in_part(evidence) ? std::optional(parts_text(evidence)) : std::nullopt;
}

std::optional<std::string> remedy_for_readings(const VerdictEvidence& evidence) {
  return are_too_thin(evidence) ? std::optional<std::string>(kReadings) : std::nullopt;
}

std::span<const VerdictRule> verdict_rules() { return kRules; }

std::optional<Objection> too_much_left_out(const Loss& loss) {
  if (!loss.of_wheels || !(loss.share > settings::kMostLeftOut)) return std::nullopt;
  return refusal(loss.text +
                 "; what is left does not tell how the robot moved: mend what sends this, and record again");
}

bool odometry_is_off(const std::vector<DriveError>& errors) { return excessive(errors) != nullptr; }

}  // namespace odomcalib::calib::report
