// Functions that stay until the opposite happens.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// The sign of the last acceleration beyond a threshold (the relay of Krasnosel'skii and Pokrovskii, Systems
/// with Hysteresis, 1989).
struct Relay {
  [[nodiscard]] static BasisValues values(const Argument& at) { return {at.z}; }
  friend bool operator==(const Relay&, const Relay&) = default;
};

}  // namespace odomcalib::calib::terms
