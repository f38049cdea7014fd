// From residual to missing effect: score tests, joint refits, held-out proof, one effect after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/curves/curve.hpp"
#include "calib/tracing/fitted_model.hpp"
#include "calib/tracing/proof.hpp"

namespace odomcalib::calib {

struct Finding {
  std::shared_ptr<const Effect> effect;
  std::vector<std::string> aliases;  ///< candidates the data cannot tell from it
  Proof proof;
};

/// A curve that the search added to the model.
struct AddedCurve {
  std::shared_ptr<const Effect> effect;
  Curve curve;
  Proof proof;
  /// The named effect whose law the curve completes: the data want another law than the textbook's. Null:
  /// nothing in the catalogue explains it.
  std::shared_ptr<const Effect> law_of;
  /// Variables that moved together with the curve's own in this drive, so that either may be meant.
  std::vector<Variable> alike = {};
};

/// A candidate that passed the score test, and what became of it.
struct Considered {
  std::string name;
  double statistic = 0.0;
  double family_p_value = 1.0;
  std::string outcome;
};

struct SearchResult {
  FittedModel model;  ///< effects given, then what was added
  std::vector<Finding> findings;
  std::vector<AddedCurve> curves;
  EffectList quiet;                    ///< in the model, but too small to be told
  std::vector<Considered> considered;  ///< in the order tried
  /// What nobody knows about a law is unknown of the base parameters too: by how much they move with another
  /// shape, another zero or another name of the set, by extrapolation to where no effect is, and with what
  /// was too small to be told.
  std::vector<Eigen::VectorXd> doubts;

  [[nodiscard]] bool has_unnamed() const;
};

/// Stepwise search from a fitted model. Nothing is added unless it passes family-wise and the held-out error
/// goes down with a 95 % interval that excludes "no change".
SearchResult search_effects(std::span<const FitData> data, const EffectList& given, const FitResult& fit,
                            const std::vector<bool>& base_fixed, const std::function<void(double)>& progress);

}  // namespace odomcalib::calib
