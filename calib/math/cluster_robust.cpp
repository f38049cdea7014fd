#include "calib/math/cluster_robust.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "calib/math/settings.hpp"

namespace odomcalib::calib::math {
namespace {

constexpr double kNever = -1e300;

/// How much larger the scatter of so many blocks may look by chance.
double by_chance(double blocks) {
  const boost::math::chi_squared distribution(blocks - 1.0);
  return boost::math::quantile(boost::math::complement(distribution, settings::kLongerByChance)) /
         (blocks - 1.0);
}

}  // namespace

ClusterRobust::ClusterRobust(Eigen::MatrixXd inverse)
    : inverse_(std::move(inverse)), recordings_(1), begin_(kNever) {}

void ClusterRobust::add(double time, const Eigen::VectorXd& score) {
  std::vector<Eigen::VectorXd>& blocks = recordings_.back();
  if (time > begin_ + settings::kBlock_s) {
    blocks.emplace_back(Eigen::VectorXd::Zero(inverse_.rows()));
    begin_ = time;
  }
  blocks.back() += score;
}

void ClusterRobust::end_recording() {
  recordings_.emplace_back();
  begin_ = kNever;
}

ClusterRobust::Scatter ClusterRobust::scatter(std::size_t joined) const {
  Scatter found{Eigen::VectorXd::Zero(inverse_.rows())};
  for (const auto& blocks : recordings_)
    for (std::size_t first = 0; first < blocks.size(); first += joined) {
      Eigen::VectorXd sum = blocks[first];
      for (std::size_t k = first + 1; k < std::min(first + joined, blocks.size()); ++k) sum += blocks[k];
      if (sum.isZero()) continue;
      found.variances += (inverse_ * sum).cwiseAbs2();
      found.blocks += 1.0;
    }
  if (found.blocks > 1.0) found.variances *= found.blocks / (found.blocks - 1.0);
  return found;
}

Eigen::VectorXd ClusterRobust::variances() const {
  const Eigen::VectorXd shortest = scatter(1).variances;
  Eigen::VectorXd largest = shortest;
  std::size_t longest = 0;
  for (const auto& blocks : recordings_) longest = std::max(longest, blocks.size());
  for (std::size_t joined = 2; joined <= longest; joined *= 2) {
    const Scatter longer = scatter(joined);
    if (longer.blocks < settings::kFewestScattered) break;
    const double limit = by_chance(longer.blocks);
    for (Eigen::Index k = 0; k < largest.size(); ++k)
      if (longer.variances(k) > limit * shortest(k)) largest(k) = std::max(largest(k), longer.variances(k));
  }
  return largest;
}

Eigen::MatrixXd ClusterRobust::inflated(double variance) const {
  const Eigen::VectorXd robust = variances();
  Eigen::VectorXd inflation = Eigen::VectorXd::Ones(inverse_.rows());
  for (Eigen::Index k = 0; k < inverse_.rows(); ++k)
    if (inverse_(k, k) > 0.0) inflation(k) = std::sqrt(std::max(variance, robust(k) / inverse_(k, k)));
  return inflation.asDiagonal() * inverse_ * inflation.asDiagonal();
}

}  // namespace odomcalib::calib::math
