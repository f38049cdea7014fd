#include "calib/map/adjust.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/geometry/vector2.hpp"
#include "calib/statistics/tukey.hpp"

namespace odomcalib::calib {
namespace {

constexpr int kRounds = 3;
constexpr double kPrior = 1e-6;  ///< relative to the largest, for walls that nobody strikes

/// What one scan says about its pose and the walls it strikes.
struct ScanTerms {
  Eigen::Matrix3d pose = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  std::vector<Eigen::Index> walls;
  std::vector<Eigen::Matrix<double, 3, 2>> mixed;
};

class Adjustment {
 public:
  explicit Adjustment(std::size_t walls)
      : size_(2 * static_cast<Eigen::Index>(walls)),
        matrix_(Eigen::MatrixXd::Zero(size_, size_)),
        right_side_(Eigen::VectorXd::Zero(size_)) {}

  /// @param anchored the pose stays, which ties the frame of the map
  ScanTerms add(const WallMap& map, const std::vector<Beam>& beams, const Place& place,
                const PlaceOptions& options, bool anchored) {
    ScanTerms terms;
    std::vector<Eigen::Index> slot(map.walls().size(), -1);
    const Frame sensor(place.pose);
    for (const Strike& strike : map.strikes(beams, place.pose)) {
      const RangeTerm term = map.term(beams[strike.beam], strike.wall, sensor, options.range_noise);
      const double weight = weight_of(term, place.scale);
      if (weight > 0.0) enter(term, strike.wall, weight, slot, terms);
    }
    if (!anchored) eliminate(terms);
    return terms;
  }

  [[nodiscard]] Eigen::VectorXd solve() const {
    Eigen::MatrixXd damped = matrix_;
    damped.diagonal().array() += kPrior * matrix_.diagonal().maxCoeff();
    return damped.ldlt().solve(right_side_);
  }

 private:
  void enter(const RangeTerm& term, std::size_t wall, double weight, std::vector<Eigen::Index>& slot,
             ScanTerms& terms) {
    const auto at = 2 * static_cast<Eigen::Index>(wall);
    if (slot[wall] < 0) {
      slot[wall] = static_cast<Eigen::Index>(terms.walls.size());
      terms.walls.push_back(at);
      terms.mixed.emplace_back(Eigen::Matrix<double, 3, 2>::Zero());
    }
    terms.pose += weight * term.by_pose * term.by_pose.transpose();
    terms.gradient += weight * term.residual * term.by_pose;
    terms.mixed[static_cast<std::size_t>(slot[wall])] += weight * term.by_pose * term.by_wall.transpose();
    matrix_.block<2, 2>(at, at) += weight * term.by_wall * term.by_wall.transpose();
    right_side_.segment<2>(at) += weight * term.residual * term.by_wall;
  }

  void eliminate(const ScanTerms& terms) {
    const Eigen::LDLT<Eigen::Matrix3d> pose(terms.pose);
    const Eigen::Vector3d settled = pose.solve(terms.gradient);
    for (std::size_t i = 0; i < terms.walls.size(); ++i) {
      const Eigen::Matrix<double, 3, 2> inner = pose.solve(terms.mixed[i]);
      right_side_.segment<2>(terms.walls[i]) -= terms.mixed[i].transpose() * settled;
      for (std::size_t j = 0; j < terms.walls.size(); ++j)
        matrix_.block<2, 2>(terms.walls[j], terms.walls[i]) -= terms.mixed[j].transpose() * inner;
    }
  }

  Eigen::Index size_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_side_;
};

void move(MapWall& wall, const Eigen::Vector2d& step) {
  wall.centre -= step(0) * wall.normal;
  wall.normal = Frame({0.0, 0.0, -step(1)}).rotate(wall.normal);
}

/// Poses follow the walls.
void follow(const ScanTerms& terms, const Eigen::VectorXd& step, Pose& pose) {
  Eigen::Vector3d gradient = terms.gradient;
  for (std::size_t i = 0; i < terms.walls.size(); ++i)
    gradient -= terms.mixed[i] * step.segment<2>(terms.walls[i]);
  const Eigen::Vector3d own = terms.pose.ldlt().solve(gradient);
  pose.x -= own(0);
  pose.y -= own(1);
  pose.yaw -= own(2);
}

void adjust_once(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options, WallMap& map,
                 std::vector<Place>& places) {
  Adjustment adjustment(map.walls().size());
  std::vector<ScanTerms> all(scans.size());
  bool anchored = false;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (!places[k].is_usable()) continue;
    all[k] = adjustment.add(map, scans[k], places[k], options, !anchored);
    if (!anchored) all[k].gradient.setZero();
    anchored = true;
  }
  const Eigen::VectorXd step = adjustment.solve();
  if (!step.allFinite()) return;
  for (std::size_t w = 0; w < map.walls().size(); ++w)
    move(map.walls()[w], step.segment<2>(2 * static_cast<Eigen::Index>(w)));
  bool first = true;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (!places[k].is_usable()) continue;
    if (!first) follow(all[k], step, places[k].pose);
    first = false;
  }
}

}  // namespace

void adjust_map(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options, WallMap& map,
                std::vector<Place>& places) {
  for (int round = 0; round < kRounds; ++round) adjust_once(scans, options, map, places);
  for (std::size_t k = 0; k < scans.size(); ++k)
    if (places[k].is_usable()) places[k] = place_scan(map, scans[k], places[k].pose, options);
}

}  // namespace odomcalib::calib
