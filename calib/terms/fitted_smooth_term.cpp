#include "calib/terms/fitted_smooth_term.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

namespace odomcalib::calib::terms {
namespace {

template <typename Enum>
std::optional<Enum> enum_from(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  return std::nullopt;
}

/// Members of a smooth term's entry that belong to its basis; what the file does not say has its usual value.
struct Shape {
  double period = 0.0;
  int harmonic = 0, knots = kKnots, degree = kHighestDegree;
  double moment = 0.0, fading = 0.0;
  std::array<double, 2> wave{};
  bool constant = false, patches = false;
};

Shape shape_of(const Basis& basis) {
  const auto as_shape = []<typename Kind>(const Kind& kind) {
    Shape shape;
    if constexpr (std::is_same_v<Kind, Cycle>) shape.period = kind.period;
    if constexpr (std::is_same_v<Kind, Harmonics>) shape.harmonic = kind.only;
    if constexpr (std::is_same_v<Kind, Harmonics>) shape.constant = kind.constant;
    if constexpr (std::is_same_v<Kind, Splines>) shape.knots = kind.knots;
    if constexpr (std::is_same_v<Kind, Polynomials>) shape.degree = kind.degree;
    if constexpr (std::is_same_v<Kind, ChangePoint>) shape.moment = kind.moment;
    if constexpr (std::is_same_v<Kind, Decay>) shape.fading = kind.time_constant;
    if constexpr (std::is_same_v<Kind, Wave>) shape.wave = {kind.along_x, kind.along_y};
    shape.patches = std::is_same_v<Kind, Patches>;
    return shape;
  };
  return std::visit(as_shape, basis);
}

Shape shape_from(const SmoothTermEntry& entry) {
  return {entry.period, entry.harmonic, entry.knots,    entry.degree, entry.moment,
          entry.fading, entry.wave,     entry.constant, entry.patches};
}

/// A file may say anything.
bool is_sound(const Shape& shape, vehicle::Covariate covariate) {
  const bool is_of_time = shape.moment != 0.0 || shape.fading != 0.0;
  return shape.knots >= kKnots && shape.knots <= kMostKnots && shape.degree >= kPlainest &&
         shape.degree <= kHighestDegree && shape.moment >= 0.0 && shape.fading >= 0.0 &&
         (!is_of_time || covariate == vehicle::Covariate::time);
}

/// The basis with what the file says of it.
Basis basis_from(const Shape& shape, const Basis& usual) {
  if (std::holds_alternative<Sway>(usual)) return usual;
  if (shape.constant) return Harmonics{0, true};
  if (shape.period > 0.0) return Cycle{shape.period};
  if (std::holds_alternative<Harmonics>(usual)) return Harmonics{std::max(shape.harmonic, 0)};
  if (shape.moment > 0.0) return ChangePoint{shape.moment};
  if (shape.fading > 0.0) return Decay{shape.fading};
  if (std::holds_alternative<Surface>(usual)) {
    if (shape.wave != std::array<double, 2>{}) return Wave{shape.wave[0], shape.wave[1]};
    return shape.patches ? Basis(Patches{}) : usual;
  }
  const bool is_smooth =
      std::holds_alternative<Polynomials>(usual) || std::holds_alternative<SpeedHats>(usual);
  if (is_smooth && shape.knots > kKnots) return Splines{shape.knots};
  return std::holds_alternative<Polynomials>(usual) ? Polynomials{shape.degree} : usual;
}

std::optional<FittedSmoothTerm> smooth_from(const SmoothTermEntry& entry) {
  const auto covariate = enum_from(entry.variable, vehicle::kLastCovariate);
  const auto channel = enum_from(entry.carrier, vehicle::kLastChannel);
  if (!covariate || !channel) return std::nullopt;
  const Shape shape = shape_from(entry);
  if (entry.memory >= memories_of(*covariate) || !is_sound(shape, *covariate)) return std::nullopt;
  SmoothTerm smooth{{*covariate, *channel}, entry.low, entry.high, entry.memory};
  smooth.with_motion = entry.with_motion;
  smooth.basis = basis_from(shape, smooth.basis);
  if (!(smooth.high > smooth.low) || entry.coefficients.size() != function_count(smooth)) return std::nullopt;
  smooth.mean = entry.mean;
  if (!smooth.mean.empty() && smooth.mean.size() != entry.coefficients.size()) return std::nullopt;
  return FittedSmoothTerm{smooth, entry.coefficients, entry.law_of};
}

}  // namespace

std::vector<SmoothTermEntry> entries_of(const std::vector<FittedSmoothTerm>& smooths) {
  std::vector<SmoothTermEntry> entries;
  for (const auto& [smooth, coefficients, named_term] : smooths) {
    const Shape shape = shape_of(smooth.basis);
    entries.push_back({.variable = to_string(smooth.dependence.covariate),
                       .carrier = to_string(smooth.dependence.channel),
                       .low = smooth.low,
                       .high = smooth.high,
                       .period = shape.period,
                       .mean = smooth.mean,
                       .harmonic = shape.harmonic,
                       .knots = shape.knots,
                       .degree = shape.degree,
                       .moment = shape.moment,
                       .fading = shape.fading,
                       .memory = smooth.memory,
                       .wave = shape.wave,
                       .constant = shape.constant,
                       .patches = shape.patches,
                       .with_motion = smooth.with_motion,
                       .coefficients = coefficients,
                       .law_of = named_term});
  }
  return entries;
}

std::vector<FittedSmoothTerm> smooth_terms_of(const std::vector<SmoothTermEntry>& entries) {
  std::vector<FittedSmoothTerm> smooths;
  for (const SmoothTermEntry& entry : entries)
    if (auto smooth = smooth_from(entry)) smooths.push_back(std::move(*smooth));
  return smooths;
}

}  // namespace odomcalib::calib::terms
