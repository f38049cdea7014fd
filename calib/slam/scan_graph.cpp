#include "calib/slam/scan_graph.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/math/linear_solve.hpp"
#include "calib/math/settings.hpp"
#include "calib/math/vector2.hpp"
#include "calib/slam/optimize.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

Eigen::Vector3d vector_of(const math::Pose& step) { return {step.x, step.y, math::wrap_angle(step.yaw)}; }

std::array<double, 6> information_of(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d floor = Eigen::Vector3d(settings::kMotionFloor_m * settings::kMotionFloor_m,
                                                settings::kMotionFloor_m * settings::kMotionFloor_m,
                                                settings::kMotionFloor_rad * settings::kMotionFloor_rad)
                                    .asDiagonal();
  const Eigen::Matrix3d i = math::inverse_symmetric(covariance + floor);
  return {i(0, 0), i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2)};
}

GraphEdge edge_of(std::size_t from, std::size_t to, const math::Pose& motion,
                  const Eigen::Matrix3d& covariance) {
  return {from, to, {motion.x, motion.y, math::wrap_angle(motion.yaw)}, information_of(covariance)};
}

double size_of(const math::Pose& motion) {
  return std::max(std::hypot(motion.x, motion.y), std::abs(math::wrap_angle(motion.yaw)));
}

/// Angle between the outermost readings, rad.
double view_of(const matching::Surface& surface) {
  const auto by_bearing = [](const matching::SurfacePoint& a, const matching::SurfacePoint& b) {
    return a.bearing < b.bearing;
  };
  const auto [low, high] = std::minmax_element(surface.points.begin(), surface.points.end(), by_bearing);
  return low == surface.points.end() ? 0.0 : high->bearing - low->bearing;
}

struct Loop {
  std::size_t from = 0, to = 0;
  LoopMatch match;
};

class Builder {
 public:
  Builder(std::span<const matching::Surface> surfaces, std::span<const math::Pose> odometry,
          const ScanGraphOptions& options)
      : surfaces_(surfaces), odometry_(odometry), options_(options), correction_(options.odometry_sigma) {
    out_.scans = choose_keyframes(odometry, options.spacing);
  }

  ScanGraph run() {
    for (std::size_t k = 0; k < out_.scans.size(); ++k) {
      add_vertex(k);
      for (const std::size_t j : places_seen_before(k)) look(j, k);
    }
    for (const Loop& loop : waiting_) refuse(loop, "not confirmed");
    settle_robustly(out_.graph);
    return std::move(out_);
  }

 private:
  [[nodiscard]] const matching::Surface& surface(std::size_t k) const { return surfaces_[out_.scans[k]]; }
  [[nodiscard]] math::Pose pose(std::size_t k) const {
    const GraphVertex& v = out_.graph.vertices[k];
    return {v.x, v.y, v.yaw};
  }

  void add_vertex(std::size_t k) {
    references_.push_back(std::make_unique<matching::MatchReference>(surface(k), options_.loop.range_noise));
    views_.push_back(view_of(surface(k)));
    math::Pose at;
    if (k > 0) {
      const GraphEdge edge = step_to(k);
      out_.graph.edges.push_back(edge);
      at = compose(pose(k - 1), math::Pose{edge.motion[0], edge.motion[1], edge.motion[2]});
      const math::Pose step = between(pose(k - 1), at);
      way_.push_back(way_.back() + std::max(std::hypot(step.x, step.y),
                                            settings::kTurnLever_m * std::abs(math::wrap_angle(step.yaw))));
    } else {
      way_.push_back(0.0);
    }
    out_.graph.vertices.push_back(
        {static_cast<std::int64_t>(k), VertexKind::pose, at.x, at.y, at.yaw, k == 0});
  }

  /// A match of neighbours, completed by odometry where the match leaves a direction open; odometry alone
  /// where there is no match that agrees with it.
  GraphEdge step_to(std::size_t k) {
    const math::Pose step = between(odometry_[out_.scans[k - 1]], odometry_[out_.scans[k]]);
    const math::Pose guess = correction_.corrected(step);
    const StepMatch found = match_neighbour(k, guess);
    if (found.match.ok && agrees(guess, found.match.motion)) {
      if (!found.leans_on_odometry) correction_.learn(step, found.match.motion);
      add_source(EdgeSource::match, found.match.overlap);
      return edge_of(k - 1, k, found.match.motion, found.match.covariance);
    }
    add_source(EdgeSource::odometry, 0.0);
    return edge_of(k - 1, k, guess, odometry_covariance());
  }

  void add_source(EdgeSource source, double overlap) {
    out_.sources.push_back(source);
    out_.overlaps.push_back(overlap);
  }

  [[nodiscard]] Eigen::Matrix3d odometry_covariance() const {
    return correction_.sigma().cwiseAbs2().asDiagonal();
  }

  /// As far as odometry is known by now.
  [[nodiscard]] bool agrees(const math::Pose& guess, const math::Pose& motion) const {
    const math::Pose apart = between(guess, motion);
    const Eigen::Vector3d limit =
        (settings::kMostOdometrySigmas * correction_.sigma()).cwiseMin(settings::kMostFromOdometry);
    return std::abs(apart.x) < limit(0) && std::abs(apart.y) < limit(1) &&
           std::abs(math::wrap_angle(apart.yaw)) < limit(2);
  }

  struct StepMatch {
    LoopMatch match;
    bool leans_on_odometry = false;
  };

  [[nodiscard]] StepMatch match_neighbour(std::size_t k, const math::Pose& guess) const {
    matching::MatchOptions match;
    match.range_noise = options_.loop.range_noise;
    match.min_overlap = settings::kNeighbourOverlap;
    match.guess_information = math::inverse_symmetric(odometry_covariance());
    const matching::MatchResult found = match_point_to_line(*references_[k - 1], surface(k), guess, match);
    if (found.is_usable()) return {{true, "", found.motion, found.covariance, found.overlap}};
    if (found.status == matching::MatchStatus::degenerate)
      return {
          {true, "", found.motion, with_odometry(found.information, match.guess_information), found.overlap},
          true};
    LoopCheckOptions narrow = options_.loop;
    narrow.half_width = narrow.half_angle = settings::kMostFromOdometry;
    narrow.min_overlap = settings::kNeighbourOverlap;
    return {match_loop(*references_[k - 1], surface(k), guess, narrow)};
  }

  /// Covariance where the wheels know what the scans do not tell, as along a corridor: there the scans'
  /// information may come out below zero.
  static Eigen::Matrix3d with_odometry(const Eigen::Matrix3d& scans, const Eigen::Matrix3d& odometry) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scans);
    const Eigen::Matrix3d known = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                  eigen.eigenvectors().transpose();
    return math::inverse_symmetric(known + odometry);
  }

  /// Half width of the search: what may have gone wrong since the map last closed. Errors of steps are
  /// independent, so that heading wanders with the root of the way; integrated, that displaces the end.
  [[nodiscard]] double reach(std::size_t k) const {
    const double way = way_[k] - closed_at_;
    const double wander = options_.drift * (std::sqrt(way) + std::pow(way, 1.5) / std::sqrt(3.0));
    return std::min(options_.loop.half_width + wander, settings::kWidestSearch_m);
  }

  /// Whether each of two scans with a limited view, taken in directions that are `turned` apart, sees half of
  /// what the other does.
  [[nodiscard]] bool share_view(std::size_t j, std::size_t k, double turned) const {
    const double view = std::min(views_[j], views_[k]);
    return view > settings::kAllRoundView_rad ||
           std::abs(math::wrap_angle(turned)) < settings::kSharedView * view + settings::kWidestSearch_rad;
  }

  /// The nearest ones, some keyframes apart: more of them the less the graph knows where this is.
  [[nodiscard]] std::vector<std::size_t> places_seen_before(std::size_t k) const {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < k; ++j) {
      if (way_[k] - way_[j] < options_.min_way_round) break;
      const math::Pose apart = between(pose(j), pose(k));
      const double distance = std::hypot(apart.x, apart.y);
      if (distance < reach(k) && share_view(j, k, apart.yaw))
        near.emplace_back(distance + settings::kTurnLever_m * std::abs(math::wrap_angle(apart.yaw)), j);
    }
    std::sort(near.begin(), near.end());
    std::vector<std::size_t> places;
    for (const auto& [distance, j] : near) {
      const bool close = std::any_of(places.begin(), places.end(), [j = j](std::size_t other) {
        return (other > j ? other - j : j - other) < settings::kPlacesApart;
      });
      if (!close) places.push_back(j);
      if (static_cast<double>(places.size()) >= settings::kPlacesTried * reach(k) / options_.loop.half_width)
        break;
    }
    return places;
  }

  /// Points that the keyframes next to j saw, in its frame, without those next to k.
  [[nodiscard]] std::vector<Eigen::Vector2d> seen_about(std::size_t j, std::size_t k) const {
    std::vector<Eigen::Vector2d> points;
    const std::size_t last = std::min(j + settings::kSamePlaceAbout, k - 1);
    for (std::size_t i = j > settings::kSamePlaceAbout ? j - settings::kSamePlaceAbout : 0; i <= last; ++i) {
      if (i == j) continue;
      const math::Frame frame(between(pose(j), pose(i)));
      for (const matching::SurfacePoint& point : surface(i).points)
        points.push_back(frame.transform(point.position));
    }
    return points;
  }

  void look(std::size_t j, std::size_t k) {
    LoopCheckOptions check = options_.loop;
    check.half_width = reach(k);
    check.half_angle = std::min(check.half_angle + options_.drift * std::sqrt(way_[k] - closed_at_),
                                settings::kWidestSearch_rad);
    const math::Pose guess = between(pose(j), pose(k));
    const Loop loop{j, k, match_loop(*references_[j], surface(k), guess, check, seen_about(j, k))};
    if (!loop.match.ok) return refuse(loop, loop.match.reason);
    confirm(loop);
  }

  void refuse(const Loop&, const std::string& reason) { ++out_.refused[reason]; }

  /// Two loops of different keyframes that say the same about the drift are believed, one alone is not.
  void confirm(const Loop& loop) {
    bool confirmed = false;
    std::vector<Loop> still;
    for (Loop& earlier : waiting_) {
      if (earlier.to + settings::kConfirmedWithin < loop.to)
        refuse(earlier, "not confirmed");
      else if (earlier.to != loop.to && agree(earlier, loop))
        confirmed = tie(earlier) || confirmed;
      else
        still.push_back(std::move(earlier));
    }
    waiting_ = std::move(still);
    if (confirmed)
      tie(loop);
    else
      waiting_.push_back(loop);
  }

  [[nodiscard]] bool agree(const Loop& a, const Loop& b) const {
    const std::size_t apart = a.from > b.from ? a.from - b.from : b.from - a.from;
    if (apart > settings::kSamePlaceKeyframes &&
        size_of(between(pose(a.from), pose(b.from))) > settings::kSamePlace_m)
      return false;
    const math::Pose by_a = compose(compose(between(pose(b.from), pose(a.from)), a.match.motion),
                                    between(pose(a.to), pose(b.to)));
    const math::Pose error = between(by_a, b.match.motion);
    return std::hypot(error.x, error.y) < settings::kLoopsAgree_m &&
           std::abs(math::wrap_angle(error.yaw)) < settings::kLoopsAgree_rad;
  }

  /// The edge stays if the graph can live with it.
  bool tie(const Loop& loop) {
    const PoseGraph before = out_.graph;
    out_.graph.edges.push_back(edge_of(loop.from, loop.to, loop.match.motion, loop.match.covariance));
    const GraphSummary summary = optimize_graph(out_.graph);
    PoseGraph alone = out_.graph;
    alone.edges = {out_.graph.edges.back()};
    if (!summary.is_usable() || graph_chi2(alone) > settings::kMostLoopChi2) {
      out_.graph = before;
      refuse(loop, "contradicts the graph");
      return false;
    }
    add_source(EdgeSource::loop, loop.match.overlap);
    closed_at_ = way_[loop.to];
    return true;
  }

  std::span<const matching::Surface> surfaces_;
  std::span<const math::Pose> odometry_;
  const ScanGraphOptions& options_;
  OdometryCorrection correction_;
  ScanGraph out_;
  std::vector<std::unique_ptr<matching::MatchReference>> references_;  ///< of each vertex
  std::vector<double> way_;    ///< to each vertex: m, turning counted, too
  std::vector<double> views_;  ///< of each vertex, rad
  double closed_at_ = 0.0;     ///< way at the last loop
  std::vector<Loop> waiting_;  ///< to be confirmed
};

}  // namespace

OdometryCorrection::OdometryCorrection(double sigma)
    : first_sigma_(sigma),
      information_(Eigen::Matrix3d::Identity() * (sigma * sigma) /
                   (settings::kCorrectionPrior * settings::kCorrectionPrior)),
      products_(Eigen::Matrix3d::Zero()),
      sigma_(Eigen::Vector3d::Constant(sigma)),
      squares_(Eigen::Vector3d::Constant(settings::kPriorSteps * sigma * sigma)),
      count_(settings::kPriorSteps) {}

void OdometryCorrection::learn(const math::Pose& odometry, const math::Pose& measured) {
  const Eigen::Vector3d step = vector_of(odometry);
  Eigen::Vector3d error = vector_of(measured) - step;
  error(2) = math::wrap_angle(error(2));
  const Eigen::Vector3d rest = error - systematic_ * step;
  if ((rest.cwiseQuotient(sigma_).cwiseAbs().array() > math::settings::kClearSigmas).any()) return;
  information_ += step * step.transpose();
  products_ += error * step.transpose();
  systematic_ = information_.ldlt().solve(products_.transpose()).transpose();
  squares_ += rest.cwiseAbs2();
  count_ += 1.0;
  sigma_ = (squares_ / count_).cwiseSqrt().cwiseMax(settings::kLeastOdometrySigma).cwiseMin(first_sigma_);
}

math::Pose OdometryCorrection::corrected(const math::Pose& odometry) const {
  const Eigen::Vector3d step = vector_of(odometry), whole = step + systematic_ * step;
  return {whole(0), whole(1), math::wrap_angle(whole(2))};
}

std::size_t ScanGraph::count(EdgeSource source) const {
  return static_cast<std::size_t>(std::count(sources.begin(), sources.end(), source));
}

ScanGraph build_scan_graph(std::span<const matching::Surface> surfaces, std::span<const math::Pose> odometry,
                           const ScanGraphOptions& options) {
  return Builder(surfaces, odometry, options).run();
}

std::vector<std::size_t> choose_keyframes(std::span<const math::Pose> odometry,
                                          const KeyframeSpacing& spacing) {
  std::vector<std::size_t> chosen;
  double travel = 0.0, turn = 0.0;
  for (std::size_t k = 0; k < odometry.size(); ++k) {
    if (k > 0) {
      const math::Pose step = between(odometry[k - 1], odometry[k]);
      travel += std::hypot(step.x, step.y);
      turn += std::abs(math::wrap_angle(step.yaw));
    }
    // A hair below the limit counts: sums of many steps are not exact.
    const bool far = travel > spacing.distance - 1e-9 || turn > spacing.rotation - 1e-9;
    if (!chosen.empty() && !far) continue;
    chosen.push_back(k);
    travel = turn = 0.0;
  }
  return chosen;
}

}  // namespace odomcalib::calib::slam
