// One round of the search: what the candidates come to on one model, and what to add next.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/selection/candidate.hpp"
#include "calib/selection/fitted_model.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

struct Trial {
  std::size_t candidate = 0;
  FittedModel model;  ///< with the candidate as the last effect
  double gain = 0.0;  ///< drop of -2 log L minus q log(3 n)
};

/// Scores of all candidates on a model, and joint refits of those that are wanted, each made once.
class SearchRound {
 public:
  /// Condition on a candidate's index.
  using Wanted = std::function<bool(std::size_t)>;

  /// @param candidates must outlive the round, in the same order; those excluded meanwhile no longer take
  /// part
  SearchRound(const FitTask& task, FittedModel basis, const std::vector<Candidate>& candidates);

  [[nodiscard]] const FittedModel& basis() const { return basis_; }
  [[nodiscard]] const ScoreTable& table() const { return table_; }
  [[nodiscard]] const RuleSet& rules() const { return task_.rules; }
  [[nodiscard]] const Candidate& candidate(std::size_t index) const { return candidates_[index]; }
  [[nodiscard]] const Score& score(std::size_t candidate) const { return table_.scores()[candidate]; }

  /// Joint refit on the noise model of the basis, or on another.
  /// @param noise per recording; empty: estimated anew
  [[nodiscard]] std::optional<Trial> refit(std::size_t candidate) const;
  [[nodiscard]] std::optional<Trial> refit(std::size_t candidate,
                                           const std::vector<measurement::NoiseModel>& noise) const;

  /// Adds its refit to the trials.
  void try_out(std::size_t candidate);
  /// Best of the trials.
  [[nodiscard]] std::optional<Trial> best_trial(const Wanted& wanted) const;
  /// A term's score at size zero hardly shows which of its shapes is right.
  std::optional<Trial> best_shape(const std::string& key);

  /// Candidates that are left and wanted, the most promising first.
  [[nodiscard]] std::vector<std::size_t> by_score(const Wanted& wanted) const;
  /// A smooth term on the name's own ground that explains no more than about twice as much is the same
  /// finding with a freer term; so is one that explains hardly more than the name in another shape than it
  /// was refitted from.
  [[nodiscard]] bool smooth_beats(std::size_t smooth, std::size_t name) const;

  /// Names within a few units of BIC of the best.
  [[nodiscard]] std::vector<std::size_t> competitors_of(const Trial& best) const;
  /// Changes of the base parameters by each name that may be the right one instead.
  std::vector<Eigen::VectorXd> model_uncertainties_of(const std::vector<std::size_t>& competitors,
                                                      const Trial& best);

 private:
  [[nodiscard]] bool is_open(std::size_t candidate) const { return !candidates_[candidate].excluded; }
  [[nodiscard]] double penalty(std::size_t degrees) const;
  [[nodiscard]] double penalised(std::size_t candidate) const;

  const FitTask& task_;
  const std::vector<Candidate>& candidates_;
  FittedModel basis_;
  ScoreTable table_;
  std::vector<Trial> trials_;
};

/// Cannot spoil odometry.
bool is_clock(const Candidate& candidate);

/// Whether the score is significant at the candidate's own level.
bool passes(std::size_t candidate, const SearchRound& round);

std::optional<std::size_t> best_smooth(const SearchRound& round);

/// The best name, unless the smooth term is clearly better: then one on the smooth term's own ground, which
/// may be the second best of two effects.
/// @param smooth term index of the best one, if any
std::optional<Trial> best_name_beside(std::optional<std::size_t> smooth, SearchRound& round,
                                      const SearchResult& found);

}  // namespace odomcalib::calib::selection
