#include "proto/calibration/value_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "proto/base_quantities.hpp"
#include "proto/calibration/settings.hpp"

namespace odomcalib {
namespace {

namespace settings = calibration_file::settings;

/// Units that people write beside SI: a value in one of these is a thousand times, or 57 times, what it is
/// taken for. Others are names that programs give to the same unit ("1" for rad).
bool is_beside_si(const std::string& unit) {
  static constexpr std::array kUnits = {"deg", "degrees", "mrad", "mm", "cm",   "in", "ft",
                                        "ms",  "us",      "min",  "%",  "km/h", "rpm"};
  return std::find(kUnits.begin(), kUnits.end(), unit) != kUnits.end();
}

std::string remedy_in(const std::string& unit) {
  return "state value and std in " + unit + ", or solve the recording again";
}

Error wrong_unit(const std::string& path, const std::string& unit, const std::string& own,
                 const std::string& where) {
  return {ErrorCode::refused, "\"" + path + ".unit\" is \"" + unit + "\", not \"" + own + "\"", where,
          remedy_in(own)};
}

std::optional<Error> wrong_base_value(const std::string& name, const Quantity& quantity, bool is_refused,
                                      const std::string& where) {
  const std::string path = "parameters." + name;
  const auto known = base_quantity_from(name);
  if (!known) return std::nullopt;
  const std::string unit = row_of(*known).unit;
  if (!quantity.unit.empty() && quantity.unit != unit) return wrong_unit(path, quantity.unit, unit, where);
  const bool is_angle = unit == "rad";
  const double most = is_angle ? settings::kMostAngle_rad : settings::kMostLength_m;
  if (is_refused || !(std::abs(quantity.value) > most)) return std::nullopt;
  std::ostringstream is;
  is << "is " << quantity.value << ": no robot has more than " << most << " " << unit;
  return Error{ErrorCode::refused, "\"" + path + ".value\" " + is.str(), where, remedy_in(unit)};
}

}  // namespace

std::optional<Error> wrong_value(const Calibration& calibration, const UnitOfEffect& unit_of_effect,
                                 const std::string& where) {
  const bool is_refused = calibration.verdict == Verdict::refused;
  for (const auto& [name, quantity] : calibration.parameters)
    if (auto wrong = wrong_base_value(name, quantity, is_refused, where)) return wrong;
  for (const EffectResult& effect : calibration.effects)
    for (const auto& [name, quantity] : effect.parameters) {
      const auto own = unit_of_effect ? unit_of_effect(effect.name, name) : std::nullopt;
      if (own && quantity.unit != *own && is_beside_si(quantity.unit))
        return wrong_unit("effects." + effect.name + ".parameters." + name, quantity.unit, *own, where);
    }
  return std::nullopt;
}

}  // namespace odomcalib
