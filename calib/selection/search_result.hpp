// What the search has found so far.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calib/selection/fitted_model.hpp"
#include "calib/selection/proof.hpp"
#include "calib/terms/curve.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::selection {

struct Finding {
  std::shared_ptr<const vehicle::Effect> effect;
  std::vector<std::string> aliases;  ///< candidates the data cannot tell from it
  Proof proof;
};

/// A curve that the search added to the model.
struct AddedCurve {
  std::shared_ptr<const vehicle::Effect> effect;
  terms::Curve curve;
  Proof proof;
  /// The named effect whose law the curve completes: the data want another law than the textbook's. Null:
  /// nothing in the catalogue explains it.
  std::shared_ptr<const vehicle::Effect> law_of;
  /// Variables that moved together with the curve's own in this drive, so that either may be meant.
  std::vector<vehicle::Variable> alike = {};
};

/// A candidate that passed the score test, and what became of it.
struct Considered {
  std::string name;
  double statistic = 0.0;
  double family_p_value = 1.0;
  std::string outcome;
  std::vector<vehicle::Variable> depends_on =
      {};  ///< of a curve: its variable, and those that would do as well
};

struct SearchResult {
  FittedModel model;  ///< effects given, then what was added
  std::vector<Finding> findings;
  std::vector<AddedCurve> curves;
  vehicle::EffectList quiet;           ///< in the model, but too small to be told
  std::vector<Considered> considered;  ///< in the order tried
  std::vector<Detectable> detectable;  ///< of the names that are not in the model
  /// What nobody knows about a law is unknown of the base parameters too: by how much they move with another
  /// shape, another zero or another name of the set, by extrapolation to where no effect is, and with what
  /// was too small to be told.
  std::vector<Eigen::VectorXd> doubts;

  [[nodiscard]] bool has_unnamed() const;
  /// The finding whose law a curve of that law would replace or complete; null if there is none.
  [[nodiscard]] std::shared_ptr<const vehicle::Effect> owner_of(const vehicle::Law& law) const;
  /// A law that was completed shares its ground with the curve, and keeps its name.
  [[nodiscard]] bool is_completed(const std::shared_ptr<const vehicle::Effect>& name) const;
  /// No longer told, as a name or as a curve; curves that completed its law stand for
  /// all of it then.
  void forget(const std::shared_ptr<const vehicle::Effect>& effect);
};

}  // namespace odomcalib::calib::selection
