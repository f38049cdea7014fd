// Effects of the blind test: what a real robot does beyond two round wheels. Each law is written from its
// mechanics and shares nothing with the estimators; several are in nobody's catalogue.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/sim/world/disturbance.hpp"
#include "tests/sim/world/random.hpp"

namespace odomcalib::sim {

/// Known properties of a kind of effect.
struct EffectKind {
  std::string name;
  std::string catalogue_name;           ///< nearest name in the estimators' catalogue; empty: there is none
  std::vector<std::string> depends_on;  ///< `wheel` stands for the side that is drawn
  std::string unit;
  double smallest = 0.0, largest = 0.0;  ///< sizes that the blind draw uses
  /// Makes one of the given size (unit above; 0 does nothing). Sides, phases and directions come from
  /// `random`.
  std::function<std::shared_ptr<Disturbance>(double size, Random& random)> make;
};

/// Every kind, in a fixed order. Names are unique.
const std::vector<EffectKind>& effect_kinds();
/// Kinds of no mechanism, which are in no draw unless it asks for them.
const std::vector<EffectKind>& free_laws();
/// Null when there is no such kind, free laws included.
const EffectKind* find_effect(const std::string& name);

/// An effect drawn at random.
struct DrawnEffect {
  const EffectKind* kind = nullptr;  ///< null: none
  double size = 0.0;
  std::shared_ptr<Disturbance> made;
};
/// Any kind, its size anywhere in its range on a logarithmic scale, times `size_factor`.
DrawnEffect draw_effect(Random& random, double size_factor = 1.0);

// The kinds by their place in the robot.
std::vector<EffectKind> wheel_effects();
std::vector<EffectKind> drive_train_effects();
std::vector<EffectKind> contact_effects();
std::vector<EffectKind> floor_effects();
std::vector<EffectKind> time_effects();
std::vector<EffectKind> lidar_effects();

// Helpers of the implementations.
std::size_t any_side(Random& random);
/// An angle anywhere on the circle, rad.
double any_angle(Random& random);
double any_sign(Random& random);

/// A disturbance that is only a name and a size.
class Effect : public Disturbance {
 public:
  Effect(std::string name, double size) : size_(size), name_(std::move(name)) {}
  [[nodiscard]] std::string name() const override { return name_; }

 protected:
  double size_;

 private:
  std::string name_;
};

}  // namespace odomcalib::sim
