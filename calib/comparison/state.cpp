#include "calib/comparison/state.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base_quantities.hpp"

namespace odomcalib::calib::comparison {
namespace {

std::optional<std::size_t> place_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? std::nullopt : std::optional<std::size_t>(found - names.begin());
}

State reduced_to(const State& state, const std::vector<std::string>& names) {
  std::vector<Eigen::Index> kept;
  State out;
  out.scale = state.scale;
  for (const std::string& name : names) {
    const Eigen::Index at = state.find(name).value();
    kept.push_back(at);
    out.names.push_back(name);
    out.units.push_back(state.units[static_cast<std::size_t>(at)]);
  }
  out.value = state.value(kept);
  out.covariance = state.covariance(kept, kept);
  return out;
}

/// The parameters that all of them have, in the order of the first.
std::vector<State> in_common(const std::vector<State>& states) {
  std::vector<State> out;
  if (states.empty()) return out;
  std::vector<std::string> names = states.front().names;
  for (const State& state : states)
    std::erase_if(names, [&](const std::string& name) { return !state.find(name); });
  for (const State& state : states) out.push_back(reduced_to(state, names));
  return out;
}

/// With the error of its own metre, which all lengths share.
State with_error_of_metre(State state) {
  if (!state.scale || !(state.scale->value > 0.0)) return state;
  const double relative = state.scale->std / state.scale->value;
  Eigen::VectorXd lengths = state.value;
  for (Eigen::Index k = 0; k < lengths.size(); ++k)
    if (state.units[static_cast<std::size_t>(k)] != "m") lengths(k) = 0.0;
  state.covariance += relative * relative * lengths * lengths.transpose();
  return state;
}

bool same_scale(const std::optional<Scale>& a, const std::optional<Scale>& b) {
  if (!a || !b) return !a && !b;
  return a->source == b->source && a->value == b->value && a->std == b->std;
}

}  // namespace

std::optional<Eigen::Index> State::find(const std::string& name) const {
  const auto at = place_of(names, name);
  return at ? std::optional(static_cast<Eigen::Index>(*at)) : std::nullopt;
}

State state_of(const Calibration& calibration) {
  State state;
  std::vector<Quantity> quantities;
  for (const auto& [name, quantity] : calibration.parameters) {
    if (!std::isfinite(quantity.value) || !std::isfinite(quantity.std) || !(quantity.std > 0.0)) continue;
    state.names.push_back(name);
    state.units.push_back(quantity.unit);
    quantities.push_back(quantity);
  }
  const auto size = static_cast<Eigen::Index>(quantities.size());
  state.value = Eigen::VectorXd(size);
  state.covariance = Eigen::MatrixXd::Zero(size, size);
  const std::vector<std::string>& order = calibration.covariance_order;
  for (Eigen::Index i = 0; i < size; ++i) {
    const Quantity& one = quantities[static_cast<std::size_t>(i)];
    state.value(i) = one.value;
    state.covariance(i, i) = one.std * one.std;
    for (Eigen::Index k = 0; k < size; ++k) {
      const auto row = place_of(order, state.names[static_cast<std::size_t>(i)]);
      const auto column = place_of(order, state.names[static_cast<std::size_t>(k)]);
      if (i == k || !row || !column) continue;
      const double stated = calibration.covariance[*row][*column];
      if (std::isfinite(stated)) state.covariance(i, k) = stated;
    }
  }
  state.scale = calibration.scale;
  return state;
}

Metre metre_of(std::span<const State> states) {
  if (states.empty()) return Metre::unstated;
  const auto& first = states.front().scale;
  const bool same = std::all_of(states.begin(), states.end(),
                                [&](const State& state) { return same_scale(first, state.scale); });
  if (!same) return Metre::apart;
  return first ? Metre::common : Metre::unstated;
}

std::vector<State> comparable(std::vector<State> states) {
  states = in_common(states);
  if (metre_of(states) == Metre::apart)
    for (State& state : states) state = with_error_of_metre(std::move(state));
  return states;
}

std::optional<Estimate> mean_diameter(const State& state) {
  const auto left = state.find(BaseQuantity::left_wheel_diameter),
             right = state.find(BaseQuantity::right_wheel_diameter);
  if (!left || !right) return std::nullopt;
  const Eigen::MatrixXd& c = state.covariance;
  const double variance = 0.25 * (c(*left, *left) + c(*right, *right) + 2.0 * c(*left, *right));
  return Estimate{0.5 * (state.value(*left) + state.value(*right)), std::sqrt(std::max(variance, 0.0))};
}

}  // namespace odomcalib::calib::comparison
