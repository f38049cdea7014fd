// Rule M4: sensors that are silent or frozen block motion.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/safety/settings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::safety {

using settings::kEncoderTimeout;
using settings::kScanTimeout;

/// Scans arrive and differ from each other; two equal sweeps of a real lidar do not happen.
class ScanFreshness {
 public:
  /// A scan with the very ranges of the one before counts as none.
  void seen(const Scan& scan, double now);
  /// Why motion is blocked; nullopt while scans are fresh.
  [[nodiscard]] std::optional<std::string> stale(double now) const;

 private:
  std::optional<double> last_;
  std::uint64_t fingerprint_ = 0;
  bool frozen_ = false, empty_ = false;
};

/// Counts arrive, and those of a wheel that is commanded to turn change.
class EncoderFreshness {
 public:
  void seen(const TickSample& sample, double now);
  /// Speeds in force, rad/s.
  void commanded(double left, double right, double now);
  [[nodiscard]] std::optional<std::string> stale(double now) const;

 private:
  struct Wheel {
    std::int64_t count = 0;
    double changed = 0.0;      // when the count changed
    double told_since = -1.0;  // when it was first commanded to turn; negative: it stands
  };
  static void tell(Wheel& wheel, double rate, double now);
  static bool frozen(const Wheel& wheel, double now);

  std::optional<double> last_;
  std::array<Wheel, 2> wheels_;
};

}  // namespace odomcalib::safety
