#include "calib/slam/descent.hpp"

#include <algorithm>
#include <cmath>

#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

std::vector<Eigen::Index> block_sizes(const PoseGraph& graph, Freedom freedom) {
  std::vector<Eigen::Index> sizes;
  sizes.reserve(graph.vertices.size());
  for (const GraphVertex& vertex : graph.vertices) {
    const bool turns = freedom == Freedom::poses && vertex.kind == VertexKind::pose;
    sizes.push_back(vertex.fixed ? 0 : turns ? 3 : 2);
  }
  return sizes;
}

constexpr double kSmallestMove = 1e-13;  // m or rad, beside coordinates of size 1
constexpr double kChi2Rounding = 1e-12;  // of chi2, relative: smaller falls cannot be separated from none

/// Damping after Nielsen (1999), "Damping parameter in Marquardt's method": falls smoothly with the quality
/// of the prediction, rises ever faster while steps fail.
class Damping {
 public:
  explicit Damping(bool on) : lambda_(on ? settings::kFirstLambda : 0.0) {}
  [[nodiscard]] double lambda() const { return lambda_; }
  void accepted(double quality) {
    lambda_ *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * quality - 1.0, 3));
    growth_ = 2.0;
  }
  void rejected() {
    lambda_ *= growth_;
    growth_ *= 2.0;
  }

 private:
  double lambda_;
  double growth_ = 2.0;
};

/// The fall that is left to gain, judged from how fast the last two falls shrank.
double left_to_gain(double fall_before, double fall) {
  const double rate = fall / fall_before;
  return rate >= 0.0 && rate < settings::kSteadyRate ? fall * rate / (1.0 - rate) : std::abs(fall);
}

double largest_coordinate(const Placement& at) {
  double largest = 1.0;
  for (const math::Pose& pose : at) largest = std::max({largest, std::abs(pose.x), std::abs(pose.y)});
  return largest;
}

class Run {
 public:
  Run(const PoseGraph& graph, const std::vector<std::size_t>& places, const GraphOptions& options,
      const GraphObserver& observer)
      : graph_(graph),
        places_(places),
        options_(options),
        observer_(observer),
        equations_(graph, places, Freedom::poses),
        damping_(options.method == GraphMethod::levenberg_marquardt) {}

  Descent from(Placement start) {
    at_ = std::move(start);
    chi2_ = equations_.linearize(at_);
    result_.at = at_;
    result_.chi2 = result_.chi2_start = chi2_;
    if (!std::isfinite(chi2_)) result_.state = GraphState::not_finite;
    if (equations_.unknowns() == 0) result_.state = GraphState::converged;  // everything is fixed
    for (int i = 0; i < options_.max_iterations && result_.state == GraphState::not_run; ++i) iterate();
    if (result_.state == GraphState::not_run) result_.state = GraphState::iteration_limit;
    return std::move(result_);
  }

 private:
  struct Trial {
    Placement at;
    double chi2 = 0.0;
    double length = 1.0;  // of the full step
    bool accepted = false;
  };

  void iterate() {
    if (const auto vertex = equations_.factorize(damping_.lambda())) {
      result_.undetermined = vertex;
      result_.state = GraphState::singular;
      return;
    }
    const Eigen::VectorXd step = equations_.solve();
    const double promised = equations_.predicted_fall(step, damping_.lambda());
    const double move = step.size() > 0 ? step.lpNorm<Eigen::Infinity>() : 0.0;
    Trial trial = attempt(step, promised);
    report({trial.chi2, move * trial.length, damping_.lambda(), trial.accepted});
    const bool flat =
        !(promised > options_.tolerance * chi2_) || move <= kSmallestMove * largest_coordinate(at_);
    if (flat && damping_.lambda() <= settings::kSlightLambda) result_.state = GraphState::converged;
    if (trial.accepted)
      take(std::move(trial), promised);
    else
      refuse();
  }

  Trial attempt(const Eigen::VectorXd& step, double promised) {
    const bool can_be_judged = promised > kChi2Rounding * chi2_;
    if (options_.method == GraphMethod::automatic && can_be_judged) return search_line(step, promised);
    Trial trial = moved(step, 1.0);
    const bool damped = options_.method == GraphMethod::levenberg_marquardt;
    trial.accepted = damped ? trial.chi2 < chi2_ : std::isfinite(trial.chi2);
    return trial;
  }

  [[nodiscard]] Trial moved(const Eigen::VectorXd& step, double length) const {
    Trial trial{equations_.move(at_, length * step), 0.0, length, false};
    trial.chi2 = chi2(graph_, trial.at);
    return trial;
  }

  Trial search_line(const Eigen::VectorXd& step, double promised) {
    for (double length = 1.0;; length *= 0.5) {
      Trial trial = moved(step, length);
      // The model is a parabola with its vertex at the full step.
      const double fall = promised * length * (2.0 - length);
      if (!(chi2_ - trial.chi2 >= settings::kFairFall * fall)) settle_positions(trial);
      trial.accepted = chi2_ - trial.chi2 >= settings::kSufficientFall * fall;
      if (trial.accepted || length < settings::kShortestStep) return trial;
    }
  }

  void settle_positions(Trial& trial) {
    if (!positions_) positions_.emplace(graph_, places_);
    Placement settled = positions_->solve(trial.at);
    const double chi2_settled = chi2(graph_, settled);
    if (!(chi2_settled < trial.chi2)) return;
    trial.at = std::move(settled);
    trial.chi2 = chi2_settled;
  }

  void report(const GraphIteration& iteration) {
    result_.iterations.push_back(iteration);
    if (observer_) observer_(iteration);
  }

  void take(Trial trial, double promised) {
    const double fall = chi2_ - trial.chi2;
    const bool near = std::abs(fall) > kChi2Rounding * chi2_ &&
                      left_to_gain(fall_, fall) <= options_.tolerance * trial.chi2;
    if (near && trial.length == 1.0 && damping_.lambda() <= settings::kSlightLambda)
      result_.state = GraphState::converged;
    if (damping_.lambda() > 0.0) damping_.accepted(fall / promised);
    fall_ = fall;
    at_ = std::move(trial.at);
    chi2_ = trial.chi2;
    if (chi2_ <= result_.chi2 * (1.0 + kChi2Rounding)) {
      result_.at = at_;
      result_.chi2 = chi2_;
    }
    if (result_.state == GraphState::not_run) equations_.linearize(at_);
  }

  void refuse() {
    if (result_.state != GraphState::not_run) return;  // at the bottom, rounding decides about up and down
    if (options_.method == GraphMethod::gauss_newton) {
      result_.state = GraphState::not_finite;
    } else if (options_.method == GraphMethod::automatic) {
      result_.state = GraphState::stalled;
    } else {
      damping_.rejected();
      if (damping_.lambda() > settings::kLargestLambda) result_.state = GraphState::stalled;
    }
  }

  const PoseGraph& graph_;
  const std::vector<std::size_t>& places_;
  const GraphOptions& options_;
  const GraphObserver& observer_;
  NormalEquations equations_;
  std::optional<PositionSolver> positions_;  // made when first needed
  Damping damping_;
  Placement at_;
  double chi2_ = 0.0;
  double fall_ = 0.0;  // of the last accepted step
  Descent result_;
};

}  // namespace

std::vector<BlockLink> links_of(const PoseGraph& graph) {
  std::vector<BlockLink> links;
  links.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) links.emplace_back(edge.from, edge.to);
  return links;
}

NormalEquations::NormalEquations(const PoseGraph& graph, const std::vector<std::size_t>& places,
                                 Freedom freedom)
    : graph_(graph), hessian_(block_sizes(graph, freedom), links_of(graph), places) {
  slots_.reserve(graph.edges.size());
  for (const GraphEdge& edge : graph.edges) slots_.push_back(hessian_.slot(edge.from, edge.to));
  right_side_.resize(hessian_.rows());
}

double NormalEquations::linearize(const Placement& at) {
  hessian_.set_zero();
  right_side_.setZero();
  double chi2 = 0.0;
  for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
    const Eigen::Vector3d error = edge_error(graph_.edges[k], at);
    chi2 += error.dot(information_of(graph_.edges[k]) * error);
    add_edge(k, at, error);
  }
  return chi2;
}

void NormalEquations::add_edge(std::size_t k, const Placement& at, const Eigen::Vector3d& error) {
  const GraphEdge& edge = graph_.edges[k];
  const EdgeJacobians J = edge_jacobians(edge, at);
  const Eigen::Matrix3d information = information_of(edge);
  const Eigen::Matrix3d weighted_from = J.from.transpose() * information;
  const Eigen::Matrix3d weighted_to = J.to.transpose() * information;
  const Eigen::Index from_size = hessian_.size(edge.from);
  const Eigen::Index to_size = hessian_.size(edge.to);
  if (from_size > 0) {
    hessian_.add_diagonal(edge.from, weighted_from * J.from);
    right_side_.segment(hessian_.row(edge.from), from_size) -= (weighted_from * error).head(from_size);
  }
  if (to_size > 0) {
    hessian_.add_diagonal(edge.to, weighted_to * J.to);
    right_side_.segment(hessian_.row(edge.to), to_size) -= (weighted_to * error).head(to_size);
  }
  if (from_size > 0 && to_size > 0) hessian_.add(slots_[k], edge.from, edge.to, weighted_from * J.to);
}

std::optional<std::size_t> NormalEquations::factorize(double lambda) {
  const auto singular = hessian_.factorize(lambda * hessian_.diagonal());
  if (!singular) return std::nullopt;
  for (std::size_t v = 0; v < graph_.vertices.size(); ++v)
    if (*singular >= hessian_.row(v) && *singular < hessian_.row(v) + hessian_.size(v)) return v;
  return std::nullopt;  // not reached: every row belongs to a vertex
}

// For (H + lambda D) dx = b the fall b'dx * 2 - dx'H dx is b'dx + lambda dx'D dx.
double NormalEquations::predicted_fall(const Eigen::VectorXd& step, double lambda) const {
  return right_side_.dot(step) + lambda * step.dot(hessian_.diagonal().cwiseProduct(step));
}

Placement NormalEquations::move(const Placement& at, const Eigen::VectorXd& step) const {
  Placement moved = at;
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Eigen::Index row = hessian_.row(v);
    if (hessian_.size(v) == 0) continue;
    moved[v].x += step[row];
    moved[v].y += step[row + 1];
    if (hessian_.size(v) == 3) moved[v].yaw = math::wrap_angle(moved[v].yaw + step[row + 2]);
  }
  return moved;
}

Placement PositionSolver::solve(const Placement& at) {
  equations_.linearize(at);
  return equations_.factorize(0.0) ? at : equations_.move(at, equations_.solve());
}

Descent descend(const PoseGraph& graph, const std::vector<std::size_t>& places, Placement start,
                const GraphOptions& options, const GraphObserver& observer) {
  return Run(graph, places, options, observer).from(std::move(start));
}

}  // namespace odomcalib::calib::slam
