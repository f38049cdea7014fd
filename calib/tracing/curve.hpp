// The non-parametric fallback: a defect that depends on one observed variable, whatever the law.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calib/model/drive_model.hpp"

namespace odomcalib::calib {

/// What a defect may depend on.
enum class Variable {
  left_speed,
  right_speed,
  speed,
  turn_rate,
  lateral_acceleration,
  left_acceleration,
  right_acceleration,
  left_phase,
  right_phase,
  time,
  heading,
  since_reversal,
};
std::string to_string(Variable variable);
/// Dependence on time or heading is a property of the day or of the place, not of the robot.
bool belongs_to_the_place(Variable variable);

/// How the defect enters: relative travel of a wheel, of both wheels, or sideways motion per metre.
enum class Carrier { left_travel, right_travel, both_travel, track, sideways };
std::string to_string(Carrier carrier);

/// f(z) = sum of coefficients times basis functions: Legendre polynomials of degree 1 to 4 on [low, high]
/// (the constant is a base parameter's), clamped outside; harmonics 1 to 3 for angles.
struct Curve {
  Variable variable = Variable::speed;
  Carrier carrier = Carrier::both_travel;
  double low = -1.0;
  double high = 1.0;
};

double value_of(Variable variable, const StepContext& context);
bool is_angle(Variable variable);
std::vector<double> basis(const Curve& curve, double z);

std::shared_ptr<const Effect> make_curve_effect(const Curve& curve);

/// Curves worth trying on this data: every (variable, carrier) whose variable varies, on its 0.5 to 99.5 %
/// range.
std::vector<Curve> candidate_curves(std::span<const DriveModel* const> models);

}  // namespace odomcalib::calib
