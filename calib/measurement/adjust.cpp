#include "calib/measurement/adjust.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/math/vector2.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// One scan's terms for its pose and for what all scans share: shift and turn of each wall, and the error of
/// the ranges.
struct ScanTerms {
  Eigen::Matrix3d pose = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd mixed;  ///< pose by shared
};

class Adjustment {
 public:
  explicit Adjustment(std::size_t walls)
      : of_walls_(2 * static_cast<Eigen::Index>(walls)),
        matrix_(Eigen::MatrixXd::Zero(size(), size())),
        right_side_(Eigen::VectorXd::Zero(size())) {}

  /// @param anchored the pose stays, which ties the frame of the map
  ScanTerms add(const WallMap& map, const std::vector<Beam>& beams, const Place& place,
                const PlaceOptions& options, bool anchored) {
    ScanTerms terms;
    terms.mixed.setZero(3, size());
    const math::Frame sensor(place.pose);
    for (const Strike& strike : map.strikes(beams, place.pose)) {
      const auto term = range_term(map, beams[strike.beam], strike.wall, sensor, options);
      const double weight = term ? weight_of(*term, place.scale) : 0.0;
      if (weight > 0.0) enter(*term, strike.wall, weight, terms);
    }
    if (!anchored) eliminate(terms);
    return terms;
  }

  /// Step of the walls, the ranges' error being what it is.
  [[nodiscard]] Eigen::VectorXd solve() const {
    return factors(of_walls_).solve(right_side_.head(of_walls_));
  }

  [[nodiscard]] RangeEvidence evidence() const {
    const Eigen::MatrixXd last = Eigen::MatrixXd::Identity(size(), size()).rightCols<kRangeCoefficients>();
    const auto all = factors(size()), alone = factors(of_walls_ + 1);
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(of_walls_ + 1, of_walls_);
    RangeEvidence evidence;
    evidence.values = -all.solve(right_side_).tail<kRangeCoefficients>();
    evidence.covariance = all.solve(last).bottomRows<kRangeCoefficients>();
    evidence.offset_alone = -alone.solve(right_side_.head(of_walls_ + 1))(of_walls_);
    evidence.offset_alone_deviation = std::sqrt(std::max(alone.solve(unit)(of_walls_), 0.0));
    return evidence;
  }

 private:
  [[nodiscard]] Eigen::Index size() const { return of_walls_ + kRangeCoefficients; }

  /// Factors of the matrix of the first unknowns alone.
  [[nodiscard]] Eigen::LDLT<Eigen::MatrixXd> factors(Eigen::Index count) const {
    Eigen::MatrixXd damped = matrix_.topLeftCorner(count, count);
    damped.diagonal().head(of_walls_).array() +=
        settings::kWallPrior * matrix_.diagonal().head(of_walls_).maxCoeff();
    return damped.ldlt();
  }

  void enter(const RangeTerm& term, std::size_t wall, double weight, ScanTerms& terms) {
    const Eigen::Index at = 2 * static_cast<Eigen::Index>(wall);
    const RangeErrorTerms by_range = -by_coefficient(term.sighting);
    const Eigen::Vector3d pose = weight * term.by_pose;
    terms.pose += pose * term.by_pose.transpose();
    terms.gradient += pose * term.residual;
    terms.mixed.middleCols<2>(at) += pose * term.by_wall.transpose();
    terms.mixed.rightCols<kRangeCoefficients>() += pose * by_range.transpose();
    right_side_.segment<2>(at) += weight * term.residual * term.by_wall;
    right_side_.tail<kRangeCoefficients>() += weight * term.residual * by_range;
    matrix_.block<2, 2>(at, at) += weight * term.by_wall * term.by_wall.transpose();
    const Eigen::Matrix<double, 2, kRangeCoefficients> both = weight * term.by_wall * by_range.transpose();
    matrix_.block<2, kRangeCoefficients>(at, of_walls_) += both;
    matrix_.block<kRangeCoefficients, 2>(of_walls_, at) += both.transpose();
    matrix_.bottomRightCorner<kRangeCoefficients, kRangeCoefficients>() +=
        weight * by_range * by_range.transpose();
  }

  void eliminate(const ScanTerms& terms) {
    const Eigen::LDLT<Eigen::Matrix3d> pose(terms.pose);
    right_side_ -= terms.mixed.transpose() * pose.solve(terms.gradient);
    matrix_ -= terms.mixed.transpose() * pose.solve(terms.mixed);
  }

  Eigen::Index of_walls_;  ///< unknowns; those of the ranges' error come after them
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_side_;
};

void move(MapWall& wall, const Eigen::Vector2d& step) {
  wall.centre -= step(0) * wall.normal;
  wall.normal = math::Frame({0.0, 0.0, -step(1)}).rotate(wall.normal);
}

/// Poses follow the walls.
void follow(const ScanTerms& terms, const Eigen::VectorXd& step, math::Pose& pose) {
  const Eigen::Vector3d own =
      terms.pose.ldlt().solve(terms.gradient - terms.mixed.leftCols(step.size()) * step);
  pose.x -= own(0);
  pose.y -= own(1);
  pose.yaw -= own(2);
}

RangeEvidence adjust_once(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options,
                          WallMap& map, std::vector<Place>& places) {
  Adjustment adjustment(map.walls().size());
  std::vector<ScanTerms> all(scans.size());
  const auto first = static_cast<std::size_t>(
      std::find_if(places.begin(), places.end(), [](const Place& p) { return p.is_usable(); }) -
      places.begin());
  for (std::size_t k = first; k < scans.size(); ++k)
    if (places[k].is_usable()) all[k] = adjustment.add(map, scans[k], places[k], options, k == first);
  const Eigen::VectorXd step = adjustment.solve();
  if (!step.allFinite()) return {};
  for (std::size_t w = 0; w < map.walls().size(); ++w)
    move(map.walls()[w], step.segment<2>(2 * static_cast<Eigen::Index>(w)));
  for (std::size_t k = first + 1; k < scans.size(); ++k)
    if (places[k].is_usable()) follow(all[k], step, places[k].pose);
  return adjustment.evidence();
}

}  // namespace

RangeEvidence adjust_map(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options,
                         WallMap& map, std::vector<Place>& places) {
  RangeEvidence evidence;
  for (int round = 0; round < settings::kAdjustRounds; ++round)
    evidence = adjust_once(scans, options, map, places);
  for (std::size_t k = 0; k < scans.size(); ++k)
    if (places[k].is_usable()) places[k] = place_scan(map, scans[k], places[k].pose, options);
  return evidence;
}

}  // namespace odomcalib::calib::measurement
