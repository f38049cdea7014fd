#include "calib/selection/lidar_score.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/vector2.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr unsigned kLidarFlipSeed = 20210602;

/// How much farther from the first scan's line the shift puts a point, m.
double pushed(const terms::BeamShift& shift, const Eigen::Vector2d& beam, double range,
              const Eigen::Vector2d& normal) {
  return normal.dot(shift.radial * beam + shift.angular * range * math::quarter_turn(beam));
}

struct Rows {
  Eigen::VectorXd residual;
  Eigen::MatrixXd columns;
  Eigen::MatrixXd pose;
};

Rows rows_of(const measurement::HeadingPair& pair, const std::vector<LidarColumns>& candidates,
             Eigen::Index width) {
  const auto n = static_cast<Eigen::Index>(pair.points.size());
  Rows rows{Eigen::VectorXd(n), Eigen::MatrixXd(n, width), Eigen::MatrixXd(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const measurement::DoubleSighting& p = pair.points[static_cast<std::size_t>(i)];
    const double weight = 1.0 / p.deviation;
    rows.residual(i) = weight * p.distance;
    rows.pose.row(i) << weight * p.normal.x(), weight * p.normal.y(),
        weight * p.normal.dot(math::quarter_turn(p.arm));
    for (const LidarColumns& c : candidates) {
      const auto first = c.effect->shifts(p.first), second = c.effect->shifts(p.second);
      for (Eigen::Index k = 0; k < c.count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        rows.columns(i, c.first + k) = weight * (pushed(second[at], p.second_beam, p.second.range, p.normal) -
                                                 pushed(first[at], p.first_beam, p.first.range, p.normal));
      }
    }
  }
  return rows;
}

/// Residuals far out are what the other scan did not see: they are cut, with all their columns.
void clip(Rows& rows) {
  std::vector<double> magnitudes(static_cast<std::size_t>(rows.residual.size()));
  for (Eigen::Index i = 0; i < rows.residual.size(); ++i)
    magnitudes[static_cast<std::size_t>(i)] = std::abs(rows.residual(i));
  const double limit =
      validation::settings::kClip * std::max(1.0, math::kMadToSigma * math::median_of(std::move(magnitudes)));
  for (Eigen::Index i = 0; i < rows.residual.size(); ++i)
    if (std::abs(rows.residual(i)) > limit) {
      rows.residual(i) = 0.0;
      rows.columns.row(i).setZero();
      rows.pose.row(i).setZero();
    }
}

PairScore score_of(Rows rows) {
  clip(rows);
  const Eigen::Matrix3d gram = rows.pose.transpose() * rows.pose + 1e-9 * Eigen::Matrix3d::Identity();
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(gram);
  const Eigen::MatrixXd columns = rows.columns - rows.pose * ldlt.solve(rows.pose.transpose() * rows.columns);
  const Eigen::VectorXd residual =
      rows.residual - rows.pose * ldlt.solve(rows.pose.transpose() * rows.residual);
  return {columns.transpose() * residual, columns.transpose() * columns, residual.squaredNorm(),
          static_cast<std::size_t>(rows.residual.size())};
}

PairScore& operator+=(PairScore& sum, const PairScore& pair) {
  sum.gradient += pair.gradient;
  sum.gram += pair.gram;
  sum.squares += pair.squares;
  sum.points += pair.points;
  return sum;
}

/// Basis of the directions that the pairs can see, orthonormal in `gram`: B' gram B = I.
Eigen::MatrixXd visible(const Eigen::MatrixXd& gram, double raw) {
  if (gram.size() == 0) return gram;
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  const math::Eigensystem eigen = math::eigensystem(scaled);
  Eigen::MatrixXd basis(gram.rows(), 0);
  for (Eigen::Index k = 0; k < gram.rows(); ++k) {
    const double value = eigen.values(k);
    if (value < raw) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.col(basis.cols() - 1) = scale.asDiagonal() * eigen.vectors.col(k) / std::sqrt(value);
  }
  return basis;
}

Eigen::MatrixXd part(const Eigen::MatrixXd& m, const std::vector<Eigen::Index>& rows,
                     const std::vector<Eigen::Index>& columns) {
  return m(rows, columns);
}

/// A candidate's scores, pair by pair, beside what is accepted, in an orthonormal basis: degrees x pairs.
/// @param total of all pairs
Eigen::MatrixXd project(const std::vector<PairScore>& pairs, const PairScore& total,
                        const std::vector<Eigen::Index>& accepted, const std::vector<Eigen::Index>& own) {
  Eigen::MatrixXd onto(static_cast<Eigen::Index>(accepted.size()), static_cast<Eigen::Index>(own.size()));
  Eigen::VectorXd values(static_cast<Eigen::Index>(accepted.size()));
  Eigen::MatrixXd rest = part(total.gram, own, own);
  if (!accepted.empty()) {
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(part(total.gram, accepted, accepted));
    onto = ldlt.solve(part(total.gram, accepted, own));
    values = ldlt.solve(total.gradient(accepted));
    rest -= part(total.gram, own, accepted) * onto;
  }
  const Eigen::MatrixXd basis = visible(rest, settings::kVisible);
  Eigen::MatrixXd projected(basis.cols(), static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t g = 0; g < pairs.size(); ++g) {
    Eigen::VectorXd s = pairs[g].gradient(own);
    if (!accepted.empty()) {
      s -= part(pairs[g].gram, own, accepted) * values;
      const Eigen::VectorXd left =
          pairs[g].gradient(accepted) - part(pairs[g].gram, accepted, accepted) * values;
      s -= onto.transpose() * left;
    }
    projected.col(static_cast<Eigen::Index>(g)) = basis.transpose() * s;
  }
  return projected;
}

/// Random signs for the pairs: what statistics look like when nothing is missing. Errors that points of one
/// pair share make them larger than chi-squared, all by about the same factor.
class SignFlips {
 public:
  SignFlips(const std::vector<Eigen::MatrixXd>& scores, std::size_t pairs) {
    std::mt19937 engine(kLidarFlipSeed);
    std::vector<double> sums(scores.size(), 0.0);
    std::vector<Eigen::VectorXd> draws;
    for (int draw = 0; draw < settings::kSignDraws; ++draw) {
      Eigen::VectorXd signs(static_cast<Eigen::Index>(pairs));
      for (Eigen::Index g = 0; g < signs.size(); ++g) signs(g) = (engine() & 1U) != 0U ? 1.0 : -1.0;
      Eigen::VectorXd statistics = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(scores.size()));
      for (std::size_t c = 0; c < scores.size(); ++c)
        if (scores[c].rows() > 0)
          sums[c] += statistics(static_cast<Eigen::Index>(c)) = (scores[c] * signs).squaredNorm();
      draws.push_back(statistics);
    }
    for (std::size_t c = 0; c < scores.size(); ++c)
      if (scores[c].rows() > 0)
        inflation_ =
            std::min(inflation_, sums[c] / settings::kSignDraws / static_cast<double>(scores[c].rows()));
    inflation_ = std::max(inflation_, 1.0);
    for (const Eigen::VectorXd& statistics : draws) largest_.push_back(largest(statistics, scores));
  }

  [[nodiscard]] double inflation() const { return inflation_; }
  [[nodiscard]] static double smallest() { return 1.0 / (1.0 + settings::kSignDraws); }
  [[nodiscard]] double family_p_value(double statistic, Eigen::Index degrees) const {
    const double own = significance(statistic, degrees);
    const auto above = std::count_if(largest_.begin(), largest_.end(), [&](double v) { return v >= own; });
    return (1.0 + static_cast<double>(above)) / (1.0 + settings::kSignDraws);
  }

 private:
  [[nodiscard]] double largest(const Eigen::VectorXd& statistics,
                               const std::vector<Eigen::MatrixXd>& scores) const {
    double best = 0.0;
    for (std::size_t c = 0; c < scores.size(); ++c)
      if (scores[c].rows() > 0)
        best = std::max(
            best, significance(statistics(static_cast<Eigen::Index>(c)) / inflation_, scores[c].rows()));
    return best;
  }

  double inflation_ = 1e300;
  std::vector<double> largest_;
};

/// Beside a large effect every draw of signs is large. Far out, Bonferroni's bound needs no draws.
bool is_decisive(const LidarScores::Score& score, std::size_t family) {
  const double tail = chi_squared_tail(score.statistic, static_cast<std::size_t>(score.degrees));
  return tail * static_cast<double>(family) < settings::kDecisive;
}

/// Gain of one pair's distances by these values.
double gain_of_columns(const PairScore& pair, const std::vector<Eigen::Index>& columns,
                       const Eigen::VectorXd& values) {
  return 2.0 * values.dot(pair.gradient(columns)) - values.dot(part(pair.gram, columns, columns) * values);
}

Eigen::VectorXd solved(const std::vector<PairScore>& pairs, const std::vector<Eigen::Index>& columns,
                       std::size_t without_fold) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  for (std::size_t g = 0; g < pairs.size(); ++g) {
    if (without_fold < validation::kFolds && g * validation::kFolds / pairs.size() == without_fold) continue;
    gram += part(pairs[g].gram, columns, columns);
    gradient += pairs[g].gradient(columns);
  }
  const Eigen::MatrixXd basis = visible(gram, settings::kVisible);
  return basis * (basis.transpose() * gradient);
}

}  // namespace

LidarScores::LidarScores(const std::vector<measurement::HeadingPair>& pairs,
                         const std::vector<terms::LidarEffectPtr>& candidates) {
  Eigen::Index width = 0;
  for (const auto& effect : candidates) {
    const auto count = static_cast<Eigen::Index>(effect->parameters().size());
    candidates_.push_back({effect, width, count});
    width += count;
  }
  total_ = {Eigen::VectorXd::Zero(width), Eigen::MatrixXd::Zero(width, width)};
  std::vector<double> deviations;
  for (const measurement::HeadingPair& pair : pairs) {
    pairs_.push_back(score_of(rows_of(pair, candidates_, width)));
    total_ += pairs_.back();
    for (const measurement::DoubleSighting& p : pair.points) deviations.push_back(p.deviation);
  }
  if (!deviations.empty()) typical_deviation_ = math::median_of(std::move(deviations));
}

std::vector<Eigen::Index> LidarScores::columns(const std::vector<std::size_t>& effects) const {
  std::vector<Eigen::Index> all;
  for (const std::size_t e : effects)
    for (Eigen::Index k = 0; k < candidates_[e].count; ++k) all.push_back(candidates_[e].first + k);
  return all;
}

double LidarScores::variance(const std::vector<Eigen::Index>& taken) const {
  const Eigen::VectorXd values = solved(pairs_, taken, validation::kFolds);
  double squares = 0.0, points = 0.0;
  for (const PairScore& pair : pairs_) {
    squares += pair.squares - gain_of_columns(pair, taken, values);
    points += static_cast<double>(pair.points);
  }
  return squares / std::max(points, 1.0);
}

std::vector<LidarScores::Score> LidarScores::score(const std::vector<std::size_t>& accepted) const {
  const std::vector<Eigen::Index> taken = columns(accepted);
  const double variance = this->variance(taken);
  std::vector<Score> scores(candidates_.size());
  std::vector<Eigen::MatrixXd> projected;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    const bool is_taken = std::find(accepted.begin(), accepted.end(), c) != accepted.end();
    projected.push_back(is_taken ? Eigen::MatrixXd()
                                 : project(pairs_, total_, taken, columns({c})) / std::sqrt(variance));
    scores[c].degrees = projected[c].rows();
  }
  const SignFlips flips(projected, pairs_.size());
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (scores[c].degrees == 0) continue;
    scores[c].statistic = projected[c].rowwise().sum().squaredNorm() / flips.inflation();
    scores[c].family_p_value = is_decisive(scores[c], candidates_.size())
                                   ? flips.smallest()
                                   : flips.family_p_value(scores[c].statistic, scores[c].degrees);
  }
  return scores;
}

LidarFit LidarScores::fit(const std::vector<std::size_t>& accepted) const {
  const std::vector<Eigen::Index> taken = columns(accepted);
  const auto n = static_cast<Eigen::Index>(taken.size());
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
  const Eigen::MatrixXd basis = visible(part(total_.gram, taken, taken), settings::kVisible);
  LidarFit result{solved(pairs_, taken, validation::kFolds), Eigen::VectorXd::Zero(n)};
  for (const PairScore& pair : pairs_) {
    const Eigen::VectorXd left = pair.gradient(taken) - part(pair.gram, taken, taken) * result.values;
    scatter += left * left.transpose();
  }
  const Eigen::MatrixXd inverse = basis * basis.transpose();
  result.deviations = (inverse * scatter * inverse).diagonal().cwiseMax(0.0).cwiseSqrt();
  return result;
}

LidarScores::Gain LidarScores::held_out(const std::vector<std::size_t>& accepted,
                                        std::size_t candidate) const {
  std::vector<std::size_t> more = accepted;
  more.push_back(candidate);
  const auto few_columns = columns(accepted), all_columns = columns(more);
  const double usual = total_.squares / static_cast<double>(pairs_.size());
  double before = 0.0, after = 0.0, points = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t fold = 0; fold < validation::kFolds; ++fold) {
    const Eigen::VectorXd few = solved(pairs_, few_columns, fold), all = solved(pairs_, all_columns, fold);
    for (std::size_t g = 0; g < pairs_.size(); ++g) {
      if (g * validation::kFolds / pairs_.size() != fold) continue;
      const double without = gain_of_columns(pairs_[g], few_columns, few),
                   with = gain_of_columns(pairs_[g], all_columns, all);
      before += pairs_[g].squares - without;
      after += pairs_[g].squares - with;
      points += static_cast<double>(pairs_[g].points);
      // A few pairs that gain most of it say that the gain is large, not that it is uncertain.
      const double relative = (with - without) / (pairs_[g].squares - without + usual);
      sum += relative;
      squares += relative * relative;
    }
  }
  const auto n = static_cast<double>(pairs_.size());
  const double deviation = std::sqrt(std::max(squares - sum * sum / n, 1e-300));
  return {typical_deviation_ * std::sqrt(before / points), typical_deviation_ * std::sqrt(after / points),
          sum / deviation};
}

}  // namespace odomcalib::calib::selection
