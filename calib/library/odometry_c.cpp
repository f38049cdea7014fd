// The C interface: nothing is thrown across it, and no pointer is believed in before it was looked at.
#include <odomcalib/odometry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <new>
#include <string>

#include "calib/library/drive.hpp"
#include "calib/odometry/predict.hpp"
#include "calib/terms/catalogue.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/value_check.hpp"

#ifndef ODOMCALIB_LIBRARY_VERSION
#define ODOMCALIB_LIBRARY_VERSION "unknown"
#endif

struct odomcalib_odometry {
  odomcalib::calib::library::Drive drive;
};

namespace odomcalib::calib::library {
namespace {

/// A status, and why in words.
struct Refusal {
  int status;
  std::string text;
};

void tell(const std::string& text, char* problem, std::size_t size) {
  if (problem == nullptr || size == 0) return;
  const std::size_t length = std::min(text.size(), size - 1);
  std::memcpy(problem, text.data(), length);
  problem[length] = '\0';
}

std::optional<Refusal> wrong_option(const odomcalib_options& options) {
  if (options.size < sizeof(odomcalib_options))
    return Refusal{ODOMCALIB_INVALID_ARGUMENT,
                   "options: size is not that of odomcalib_options; begin with "
                   "ODOMCALIB_OPTIONS_INIT"};
  if (!std::isfinite(options.counts_per_turn) || options.counts_per_turn < 0.0)
    return Refusal{ODOMCALIB_INVALID_ARGUMENT, "options: counts_per_turn is no number from 0 on"};
  constexpr int kFewest = 8, kMost = 32;
  if (options.counter_bits != 0 && (options.counter_bits < kFewest || options.counter_bits > kMost))
    return Refusal{ODOMCALIB_INVALID_ARGUMENT, "options: counter_bits is neither 0 nor 8 to 32"};
  return std::nullopt;
}

Refusal refusal_of(const Error& error) {
  const bool other = error.what.starts_with(kOtherVersion);
  return {other ? ODOMCALIB_OTHER_VERSION : ODOMCALIB_NOT_A_CALIBRATION, error.text()};
}

/// Checks the values that odometry divides by, or multiplies with.
std::optional<Refusal> unusable(const Calibration& calibration, const std::string& where) {
  if (const auto member = non_finite_value(calibration))
    return Refusal{ODOMCALIB_NOT_A_CALIBRATION, where + ": \"" + *member + "\" has no finite value"};
  if (const auto wrong = wrong_value(calibration, calib::terms::unit_of_effect, where))
    return Refusal{ODOMCALIB_NOT_A_CALIBRATION, wrong->text()};
  for (const BaseQuantity length : kDriveLengths)
    if (!(calibration.parameter(length).value_or(0.0) > 0.0))
      return Refusal{ODOMCALIB_NOT_A_CALIBRATION,
                     where + ": \"parameters." + name_of(length) + "\" is no length above 0"};
  const double counts = calibration.robot.ticks_per_rev;
  if (!(counts > 0.0) || !std::isfinite(counts))
    return Refusal{ODOMCALIB_NOT_A_CALIBRATION,
                   where + ": has no counts per turn; state them in the options (counts_per_turn)"};
  return std::nullopt;
}

std::optional<Refusal> open(const std::string& text, const std::string& where,
                            const odomcalib_options& options, odomcalib_odometry** odometry) {
  auto read = calibration_from_json(text, where);
  if (!read) return refusal_of(read.error());
  Calibration calibration = std::move(read).value();
  if (options.counts_per_turn > 0.0) calibration.robot.ticks_per_rev = options.counts_per_turn;
  if (calibration.verdict == Verdict::refused && options.use_refused == 0)
    return Refusal{ODOMCALIB_REFUSED,
                   where + ": this calibration was refused: " +
                       (calibration.reasons.empty() ? "no reason is stated" : calibration.reasons.front())};
  if (auto problem = unusable(calibration, where)) return problem;
  // Only odometry is kept of it: the points of its pictures are most of the file.
  calibration.picture.reset();
  *odometry = new odomcalib_odometry{Drive(calibration, options.counter_bits)};
  return std::nullopt;
}

/// Whatever is thrown ends here.
template <typename Open>
int opened(odomcalib_odometry** odometry, const odomcalib_options* stated, char* problem, std::size_t size,
           Open open_with) noexcept {
  try {
    if (odometry != nullptr) *odometry = nullptr;
    constexpr odomcalib_options kUsual = ODOMCALIB_OPTIONS_INIT;
    const odomcalib_options& options = stated != nullptr ? *stated : kUsual;
    std::optional<Refusal> refusal = wrong_option(options);
    if (odometry == nullptr) refusal = Refusal{ODOMCALIB_INVALID_ARGUMENT, "no place for the handle"};
    if (!refusal) refusal = open_with(options);
    tell(refusal ? refusal->text : "", problem, size);
    return refusal ? refusal->status : ODOMCALIB_OK;
  } catch (const std::bad_alloc&) {
    if (problem != nullptr && size > 0) problem[0] = '\0';
    return ODOMCALIB_NO_MEMORY;
  } catch (...) {
    if (problem != nullptr && size > 0) problem[0] = '\0';
    return ODOMCALIB_INTERNAL;
  }
}

/// An update of a handle, if there is one.
template <typename Update>
int updated(odomcalib_odometry* odometry, Update update) noexcept {
  if (odometry == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  try {
    return update(odometry->drive);
  } catch (...) {
    return ODOMCALIB_INTERNAL;
  }
}

int give(const math::Pose& pose, double* out) {
  out[0] = pose.x;
  out[1] = pose.y;
  out[2] = pose.yaw;
  return ODOMCALIB_OK;
}

int give(const Eigen::Matrix3d& matrix, bool is_whole, double* out) {
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 3; ++column) out[3 * row + column] = matrix(row, column);
  return is_whole ? ODOMCALIB_OK : ODOMCALIB_NOT_KNOWN;
}

/// Samples that a running drive would not take in leave the pose as it is.
Recording admitted(const Drive& drive, std::size_t count, const double* stamps, const std::int64_t* left,
                   const std::int64_t* right, std::vector<std::size_t>& samples) {
  Recording recording;
  recording.robot = drive.calibration().robot;
  SampleGate gate(drive.metres_per_count());
  std::int32_t segment = 0;
  const auto add = [&](const TickSample& sample, std::size_t k) {
    recording.ticks.push_back({sample.t, sample.left, sample.right, segment});
    samples.push_back(k);
  };
  for (std::size_t k = 0; k < count; ++k) {
    const TickSample sample{stamps[k], left[k], right[k], 0};
    const bool counted =
        std::max(std::abs(static_cast<double>(left[k])), std::abs(static_cast<double>(right[k]))) <=
        static_cast<double>(settings::kMostCounts);
    if (!std::isfinite(sample.t) || !counted) continue;
    const Admission admission = gate.admit(sample);
    if (admission == Admission::anew) ++segment;
    const bool rises = recording.ticks.empty() || sample.t > recording.ticks.back().t;
    if ((admission == Admission::goes_on || admission == Admission::anew) && rises) add(sample, k);
  }
  return recording;
}

int path(const Drive& drive, std::size_t count, const double* stamps, const std::int64_t* left,
         const std::int64_t* right, double* poses) {
  std::vector<std::size_t> samples;
  const Recording recording = admitted(drive, count, stamps, left, right, samples);
  const std::vector<PoseSample> known = odometry::predict(recording, drive.calibration());
  const auto is_finite = [](const PoseSample& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.yaw);
  };
  const bool leads_somewhere = std::all_of(known.begin(), known.end(), is_finite);
  if (!leads_somewhere) std::fill_n(poses, 3 * count, 0.0);
  if (!leads_somewhere) return ODOMCALIB_NOT_A_NUMBER;
  PoseSample here;
  for (std::size_t k = 0, next = 0; k < count; ++k) {
    if (next < known.size() && samples[next] == k) here = known[next++];
    give(math::Pose{here.x, here.y, here.yaw}, poses + 3 * k);
  }
  return ODOMCALIB_OK;
}

}  // namespace
}  // namespace odomcalib::calib::library

using namespace odomcalib::calib;           // NOLINT(google-build-using-namespace)
using namespace odomcalib::calib::library;  // NOLINT(google-build-using-namespace)

extern "C" {

const char* odomcalib_status_name(int status) {
  static constexpr const char* kNames[] = {
      "OK",           "INVALID_ARGUMENT", "CANNOT_READ", "NOT_A_CALIBRATION", "OTHER_VERSION", "REFUSED",
      "NOT_A_NUMBER", "STAMP_NOT_LATER",  "JUMP",        "OTHER_MOTION",      "NOT_KNOWN",     "NO_MEMORY",
      "INTERNAL"};
  return status >= 0 && status < static_cast<int>(std::size(kNames)) ? kNames[status] : "UNKNOWN";
}

const char* odomcalib_version(void) { return ODOMCALIB_LIBRARY_VERSION; }

int odomcalib_odometry_open(const char* path, const odomcalib_options* options, odomcalib_odometry** odometry,
                            char* problem, size_t size) {
  return opened(
      odometry, options, problem, size, [&](const odomcalib_options& with) -> std::optional<Refusal> {
        if (path == nullptr) return Refusal{ODOMCALIB_INVALID_ARGUMENT, "no path"};
        std::ifstream file(path, std::ios::binary);
        const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        if (!file.is_open() || file.bad())
          return Refusal{ODOMCALIB_CANNOT_READ,
                         std::string(path) + ": cannot be read; check the name and the permissions"};
        return open(text, path, with, odometry);
      });
}

int odomcalib_odometry_open_text(const char* text, size_t length, const odomcalib_options* options,
                                 odomcalib_odometry** odometry, char* problem, size_t size) {
  return opened(odometry, options, problem, size,
                [&](const odomcalib_options& with) -> std::optional<Refusal> {
                  if (text == nullptr) return Refusal{ODOMCALIB_INVALID_ARGUMENT, "no text"};
                  return open(std::string(text, length), "calibration", with, odometry);
                });
}

void odomcalib_odometry_close(odomcalib_odometry* odometry) { delete odometry; }

int odomcalib_odometry_update_counts(odomcalib_odometry* odometry, double stamp, int64_t left,
                                     int64_t right) {
  return updated(odometry, [&](Drive& drive) { return drive.update_counts(stamp, {left, right}); });
}

int odomcalib_odometry_update_angles(odomcalib_odometry* odometry, double stamp, double left, double right) {
  return updated(odometry, [&](Drive& drive) { return drive.update_angles(stamp, {left, right}); });
}

int odomcalib_odometry_update_speeds(odomcalib_odometry* odometry, double stamp, double left, double right) {
  return updated(odometry, [&](Drive& drive) { return drive.update_speeds(stamp, {left, right}); });
}

int odomcalib_odometry_restart(odomcalib_odometry* odometry) {
  return updated(odometry, [](Drive& drive) { return drive.restart(); });
}

int odomcalib_odometry_set_pose(odomcalib_odometry* odometry, const double pose[3]) {
  if (pose == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return updated(odometry, [&](Drive& drive) { return drive.set_pose({pose[0], pose[1], pose[2]}); });
}

double odomcalib_odometry_stamp(const odomcalib_odometry* odometry) {
  return odometry != nullptr ? odometry->drive.stamp() : 0.0;
}

int odomcalib_odometry_pose(const odomcalib_odometry* odometry, double pose[3]) {
  if (odometry == nullptr || pose == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return give(odometry->drive.pose(), pose);
}

int odomcalib_odometry_velocity(const odomcalib_odometry* odometry, double velocity[3]) {
  if (odometry == nullptr || velocity == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return give(odometry->drive.velocity(), velocity);
}

int odomcalib_odometry_covariance(const odomcalib_odometry* odometry, double covariance[9]) {
  if (odometry == nullptr || covariance == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return give(odometry->drive.covariance(), odometry->drive.covariance_is_whole(), covariance);
}

int odomcalib_odometry_velocity_covariance(const odomcalib_odometry* odometry, double covariance[9]) {
  if (odometry == nullptr || covariance == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return give(odometry->drive.velocity_covariance(), odometry->drive.covariance_is_whole(), covariance);
}

int odomcalib_odometry_lidar_pose(const odomcalib_odometry* odometry, double pose[3]) {
  if (odometry == nullptr || pose == nullptr) return ODOMCALIB_INVALID_ARGUMENT;
  return updated(const_cast<odomcalib_odometry*>(odometry), [&](const Drive& drive) {
    using odomcalib::BaseQuantity;
    const odomcalib::Calibration& calibration = drive.calibration();
    const auto x = calibration.parameter(BaseQuantity::lidar_x),
               y = calibration.parameter(BaseQuantity::lidar_y),
               yaw = calibration.parameter(BaseQuantity::lidar_yaw);
    return x && y && yaw ? give(math::Pose{*x, *y, *yaw}, pose) : static_cast<int>(ODOMCALIB_NOT_KNOWN);
  });
}

double odomcalib_odometry_clock_offset(const odomcalib_odometry* odometry) {
  return odometry != nullptr ? odometry->drive.clock_offset() : 0.0;
}

int odomcalib_odometry_correct_beams(const odomcalib_odometry* odometry, size_t count, const float* bearings,
                                     const float* ranges, float* corrected_bearings,
                                     float* corrected_ranges) {
  const bool complete = bearings != nullptr && ranges != nullptr && corrected_bearings != nullptr &&
                        corrected_ranges != nullptr;
  if (odometry == nullptr || (count > 0 && !complete)) return ODOMCALIB_INVALID_ARGUMENT;
  return updated(const_cast<odomcalib_odometry*>(odometry), [&](const Drive& drive) {
    for (size_t k = 0; k < count; ++k) {
      const auto bearing = static_cast<double>(bearings[k]), range = static_cast<double>(ranges[k]);
      const terms::BeamShift shift = drive.shift({bearing, range, 0.0});
      corrected_bearings[k] = static_cast<float>(bearing - shift.angular);
      corrected_ranges[k] = range > 0.0 ? static_cast<float>(std::max(range - shift.radial, 0.0)) : ranges[k];
    }
    return static_cast<int>(ODOMCALIB_OK);
  });
}

size_t odomcalib_odometry_effect_count(const odomcalib_odometry* odometry) {
  return odometry != nullptr ? odometry->drive.effects().size() : 0;
}

int odomcalib_odometry_effect(const odomcalib_odometry* odometry, size_t index, odomcalib_effect* effect) {
  if (odometry == nullptr || effect == nullptr || effect->size < sizeof(odomcalib_effect))
    return ODOMCALIB_INVALID_ARGUMENT;
  if (index >= odometry->drive.effects().size()) return ODOMCALIB_INVALID_ARGUMENT;
  const EffectUse& use = odometry->drive.effects()[index];
  effect->name = use.name.c_str();
  effect->value = use.value;
  effect->unit = use.unit.c_str();
  effect->place = use.place;
  effect->why = use.why.c_str();
  return ODOMCALIB_OK;
}

const char* odomcalib_odometry_problem(const odomcalib_odometry* odometry) {
  return odometry != nullptr ? odometry->drive.problem() : "no handle";
}

int odomcalib_odometry_path(const odomcalib_odometry* odometry, size_t count, const double* stamps,
                            const int64_t* left, const int64_t* right, double* poses) {
  const bool complete = stamps != nullptr && left != nullptr && right != nullptr && poses != nullptr;
  if (odometry == nullptr || (count > 0 && !complete)) return ODOMCALIB_INVALID_ARGUMENT;
  try {
    return path(odometry->drive, count, stamps, left, right, poses);
  } catch (const std::bad_alloc&) {
    return ODOMCALIB_NO_MEMORY;
  } catch (...) {
    return ODOMCALIB_INTERNAL;
  }
}

}  // extern "C"
