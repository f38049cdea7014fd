// Result of the search so far.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calib/selection/cross_validation.hpp"
#include "calib/selection/fitted_model.hpp"
#include "calib/terms/smooth_term.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::calib::selection {

struct Finding {
  std::shared_ptr<const vehicle::Effect> effect;
  std::vector<std::string> aliases;  ///< candidates the data cannot separate from it
  CrossValidation validation;
};

/// A smooth term that the search added to the model.
struct AddedSmoothTerm {
  std::shared_ptr<const vehicle::Effect> effect;
  terms::SmoothTerm smooth;
  CrossValidation validation;
  /// The named effect whose function the smooth term completes: the data want another function than the
  /// textbook's. Null: nothing in the catalogue explains it.
  std::shared_ptr<const vehicle::Effect> named_term;
  /// Covariates that moved together with the smooth term's own in this drive, so that either may be meant.
  std::vector<vehicle::Covariate> alike = {};
};

/// A candidate that passed the score test, and what became of it.
struct Considered {
  std::string name;
  double statistic = 0.0;
  double family_p_value = 1.0;
  std::string outcome;
  std::vector<vehicle::Covariate> depends_on =
      {};  ///< of a smooth term: its covariate, and those that would do as well
};

struct SearchResult {
  FittedModel model;  ///< effects given, then what was added
  std::vector<Finding> findings;
  std::vector<AddedSmoothTerm> smooths;
  vehicle::EffectList nuisance;        ///< in the model, but too small to be reported
  std::vector<Considered> considered;  ///< in the order tried
  std::vector<Detectable> detectable;  ///< of the names that are not in the model
  /// Uncertainty of the base parameters by what nobody knows about a function: how much they move with
  /// another shape, another zero or another name of the set, by extrapolation to where no effect is, and with
  /// what was too small to be reported.
  std::vector<Eigen::VectorXd> model_uncertainties;

  [[nodiscard]] bool has_unnamed() const;
  /// The finding whose function a smooth term of that dependence would replace or complete; null if there is
  /// none.
  [[nodiscard]] std::shared_ptr<const vehicle::Effect> owner_of(const vehicle::Dependence& dependence) const;
  /// A function that was completed shares its dependence with the smooth term, and keeps its name.
  [[nodiscard]] bool is_completed(const std::shared_ptr<const vehicle::Effect>& name) const;
  /// No longer reported, as a name or as a smooth term; smooth terms that completed its shape stand for
  /// all of it then.
  void forget(const std::shared_ptr<const vehicle::Effect>& effect);
};

}  // namespace odomcalib::calib::selection
