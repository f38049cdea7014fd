#include "calib/estimation/stack.hpp"

#include "calib/math/last_value.hpp"
#include "calib/math/vector2.hpp"
#include "calib/vehicle/sensitivity.hpp"

namespace odomcalib::calib::estimation {
namespace {

void add_states(const vehicle::Trajectory& trajectory, const math::Pose& mount,
                const std::vector<measurement::SensorPair>& pairs,
                std::vector<measurement::PairState>& states) {
  math::LastValue velocity([&](double time) { return sensor_velocity(trajectory, mount, time); },
                           Eigen::Vector3d::Zero());
  for (const measurement::SensorPair& pair : pairs)
    states.push_back({trajectory.at(pair.interval.begin).yaw + mount.yaw, velocity(pair.interval.begin),
                      velocity(pair.interval.end)});
}

/// 3 n.
Eigen::VectorXd residual_along(const vehicle::Trajectory& trajectory,
                               const std::vector<measurement::SensorPair>& pairs) {
  const auto predicted = trajectory.sensor_motions(intervals_of(pairs));
  Eigen::VectorXd residual(static_cast<Eigen::Index>(3 * pairs.size()));
  for (std::size_t k = 0; k < pairs.size(); ++k)
    residual.segment<3>(static_cast<Eigen::Index>(3 * k)) = math::difference(pairs[k].motion, predicted[k]);
  return residual;
}

}  // namespace

std::vector<vehicle::Interval> intervals_of(const std::vector<measurement::SensorPair>& pairs) {
  std::vector<vehicle::Interval> intervals;
  intervals.reserve(pairs.size());
  for (const measurement::SensorPair& pair : pairs) intervals.push_back(pair.interval);
  return intervals;
}

Stack make_stack(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                 const Eigen::VectorXd& p, bool derivatives) {
  Stack stack;
  std::size_t total = 0;
  for (const measurement::FitData& d : data) total += d.pairs.size();
  stack.residual.resize(static_cast<Eigen::Index>(3 * total), 1);
  stack.states.reserve(total);
  if (derivatives) stack.jacobian.resize(stack.residual.rows(), p.size());
  std::size_t row = 0;
  for (const measurement::FitData& d : data) {
    stack.first.push_back(row);
    const auto intervals = intervals_of(d.pairs);
    const vehicle::Trajectory trajectory = d.model->trajectory(vehicle::as_span(p), effects);
    stack.residual.middleRows(static_cast<Eigen::Index>(3 * row),
                              static_cast<Eigen::Index>(3 * d.pairs.size())) =
        residual_along(trajectory, d.pairs);
    if (derivatives)
      stack.jacobian.middleRows(static_cast<Eigen::Index>(3 * row),
                                static_cast<Eigen::Index>(3 * intervals.size())) =
          vehicle::Sensitivity(*d.model, trajectory, intervals).by_all();
    add_states(trajectory, vehicle::to_base(vehicle::as_span(p)).mount, d.pairs, stack.states);
    row += d.pairs.size();
  }
  stack.first.push_back(row);
  return stack;
}

Eigen::VectorXd stacked_residual(std::span<const measurement::FitData> data,
                                 const vehicle::EffectList& effects, const Eigen::VectorXd& p) {
  std::vector<Eigen::VectorXd> parts;
  Eigen::Index total = 0;
  for (const measurement::FitData& d : data) {
    parts.push_back(residual_along(d.model->trajectory(vehicle::as_span(p), effects), d.pairs));
    total += parts.back().size();
  }
  Eigen::VectorXd all(total);
  Eigen::Index first = 0;
  for (const Eigen::VectorXd& part : parts) {
    all.segment(first, part.size()) = part;
    first += part.size();
  }
  return all;
}

std::vector<Eigen::Vector3d> residuals_of(const Stack& stack, std::size_t d) {
  std::vector<Eigen::Vector3d> residuals;
  for (std::size_t k = stack.first[d]; k < stack.first[d + 1]; ++k)
    residuals.emplace_back(stack.residual.block<3, 1>(static_cast<Eigen::Index>(3 * k), 0));
  return residuals;
}

std::span<const measurement::PairState> states_of(const Stack& stack, std::size_t d) {
  return std::span(stack.states).subspan(stack.first[d], stack.first[d + 1] - stack.first[d]);
}

measurement::Whitener whitener_of(std::span<const measurement::FitData> data, const Stack& stack,
                                  const measurement::NoiseModel& noise, const std::vector<double>& weights,
                                  std::size_t d) {
  return {data[d].pairs, states_of(stack, d), noise,
          std::span(weights).subspan(stack.first[d], data[d].pairs.size())};
}

StackWhitener::StackWhitener(std::span<const measurement::FitData> data, const Stack& stack,
                             const std::vector<measurement::NoiseModel>& noise,
                             const std::vector<double>& weights)
    : first_(stack.first) {
  for (std::size_t d = 0; d < data.size(); ++d)
    whiteners_.push_back(whitener_of(data, stack, noise[d], weights, d));
}

Eigen::MatrixXd StackWhitener::operator()(Eigen::MatrixXd rows) const {
  for (std::size_t d = 0; d < whiteners_.size(); ++d) {
    const auto first = static_cast<Eigen::Index>(3 * first_[d]);
    whiteners_[d].apply(rows.middleRows(first, static_cast<Eigen::Index>(3 * (first_[d + 1] - first_[d]))));
  }
  return rows;
}

}  // namespace odomcalib::calib::estimation
