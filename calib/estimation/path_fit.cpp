#include "calib/estimation/path_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "calib/classical/motion_kinds.hpp"
#include "calib/estimation/settings.hpp"
#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/cluster_robust.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/noise_estimate.hpp"
#include "calib/vehicle/sensitivity.hpp"

namespace odomcalib::calib::estimation {
namespace {

constexpr double kMinPivot = 1e-12;

/// A motion from one placed scan to the next, in map axes.
struct Link {
  vehicle::Interval interval;
  bool follows = false;        ///< begins with the scan that the one before ends with
  math::Pose measured;         ///< in the frame of the first scan
  double heading = 0.0;        ///< of the first scan in the map
  Eigen::Matrix3d begin, end;  ///< covariances of the places
  Eigen::Matrix3d by_begin;    ///< error of the motion by that of the first place; of the second it is 1
  Eigen::Vector3d begin_velocity, end_velocity;  ///< of the sensor
  Eigen::Matrix3d forward, sideways, yaw;        ///< covariance by unit variance of the wheels' error
};

/// d^2 of the error of the wheels, `rolled` metres long: a push of the base or a turn of it, seen at the
/// sensor.
void set_wheel_errors(Link& link, const math::Pose& mount, double rolled) {
  const double base = link.heading - mount.yaw + 0.5 * link.measured.yaw;
  const Eigen::Matrix3d to_map = math::rotation_about_z(base);
  const Eigen::Vector3d forward = to_map.col(0);
  const Eigen::Vector3d sideways = to_map.col(1);
  const Eigen::Vector3d yaw = to_map * Eigen::Vector3d(-mount.y, mount.x, 1.0);
  link.forward = rolled * forward * forward.transpose();
  link.sideways = rolled * sideways * sideways.transpose();
  link.yaw = rolled * yaw * yaw.transpose();
}

/// In axes in which the sensor heads towards `heading` then.
Eigen::Vector3d velocity(const vehicle::Trajectory& trajectory, const math::Pose& mount, double time,
                         double heading) {
  const double by_wheels = trajectory.at(time).yaw + mount.yaw;
  return math::rotation_about_z(heading - by_wheels) * sensor_velocity(trajectory, mount, time);
}

double rolled_between(const wheels::WheelTrack& track, const vehicle::Interval& interval,
                      const wheels::BaseParameters& base) {
  double sum = 0.0;
  for (std::size_t k = track.interval_at(interval.begin); k <= track.interval_at(interval.end); ++k)
    sum += std::abs(track.left[k + 1] - track.left[k]) * base.left_radius +
           std::abs(track.right[k + 1] - track.right[k]) * base.right_radius;
  return std::max(0.5 * sum, settings::kLeastRolled_m);
}

Link make_link(const PathData& data, const vehicle::Trajectory& trajectory,
               const wheels::BaseParameters& base, std::size_t k) {
  const measurement::PlacedScan &a = data.scans[k], &b = data.scans[k + 1];
  Link link;
  link.interval = {a.time, b.time};
  link.measured = between(a.pose, b.pose);
  link.heading = a.pose.yaw;
  link.begin = a.covariance;
  link.end = b.covariance;
  link.by_begin << -1.0, 0.0, b.pose.y - a.pose.y, 0.0, -1.0, a.pose.x - b.pose.x, 0.0, 0.0, -1.0;
  link.begin_velocity = velocity(trajectory, base.mount, a.time, a.pose.yaw);
  link.end_velocity = velocity(trajectory, base.mount, b.time, b.pose.yaw);
  set_wheel_errors(link, base.mount, rolled_between(data.model->track(), link.interval, base));
  return link;
}

std::vector<Link> make_links(const PathData& data, const vehicle::EffectList& effects,
                             const Eigen::VectorXd& p) {
  const vehicle::Trajectory trajectory = data.model->trajectory(vehicle::as_span(p), effects);
  const wheels::BaseParameters base = vehicle::to_base(vehicle::as_span(p));
  std::vector<Link> links;
  bool joined = false;
  for (std::size_t k = 0; k + 1 < data.scans.size(); ++k) {
    const double from = data.scans[k].time, to = data.scans[k + 1].time;
    const bool whole = to - from < ingest::settings::kMaxGap_s && data.model->track().covers(from, to);
    if (whole) {
      links.push_back(make_link(data, trajectory, base, k));
      links.back().follows = joined;
    }
    joined = whole;
  }
  return links;
}

/// One recording, linearised.
struct Part {
  std::vector<Link> links;
  std::vector<vehicle::Interval> intervals;
  Eigen::MatrixXd residual;  ///< 3 n x 1, map axes
  Eigen::MatrixXd jacobian;  ///< of the prediction
};

Part make_part(const PathData& data, const vehicle::EffectList& effects, const Eigen::VectorXd& p) {
  Part part;
  part.links = make_links(data, effects, p);
  for (const Link& link : part.links) part.intervals.push_back(link.interval);
  return part;
}

void linearise(const PathData& data, const vehicle::EffectList& effects, const Eigen::VectorXd& p,
               Part& part) {
  const vehicle::Trajectory trajectory = data.model->trajectory(vehicle::as_span(p), effects);
  const auto predicted = trajectory.sensor_motions(part.intervals);
  part.jacobian = vehicle::Sensitivity(*data.model, trajectory, part.intervals).by_all();
  part.residual.resize(part.jacobian.rows(), 1);
  for (std::size_t k = 0; k < part.links.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(3 * k);
    const Eigen::Vector3d apart = math::difference(part.links[k].measured, predicted[k]);
    const Eigen::Matrix3d turn = math::rotation_about_z(part.links[k].heading);
    part.residual.block<3, 1>(row, 0) = turn * apart;
    part.jacobian.middleRows<3>(row) = (turn * part.jacobian.middleRows<3>(row)).eval();
  }
}

/// Errors of neighbouring motions share the place of a scan: covariance L L^T with L block-bidiagonal.
class Innovations {
 public:
  Innovations(const std::vector<Link>& links, const PathNoise& noise, const std::vector<bool>& out)
      : out_(out) {
    roots_.resize(links.size());
    gains_.assign(links.size(), Eigen::Matrix3d::Zero());
    for (std::size_t k = 0; k < links.size(); ++k) add(links, noise, k);
  }

  /// Rows become independent with unit variance; those left out become zero.
  void apply(Eigen::MatrixXd& rows) const {
    for (std::size_t k = 0; k < roots_.size(); ++k) {
      auto block = rows.middleRows<3>(static_cast<Eigen::Index>(3 * k));
      if (out_[k]) {
        block.setZero();
        continue;
      }
      if (k > 0) block -= gains_[k] * rows.middleRows<3>(static_cast<Eigen::Index>(3 * k - 3));
      roots_[k].matrixL().solveInPlace(block);
    }
  }

  [[nodiscard]] double log_determinant() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < roots_.size(); ++k)
      if (!out_[k]) sum += 2.0 * roots_[k].matrixLLT().diagonal().array().log().sum();
    return sum;
  }

 private:
  void add(const std::vector<Link>& links, const PathNoise& noise, std::size_t k) {
    const Link& link = links[k];
    const double place = noise.place * noise.place, jitter = noise.stamp_jitter * noise.stamp_jitter;
    const Eigen::Matrix3d begin =
        place * link.begin + jitter * link.begin_velocity * link.begin_velocity.transpose();
    const Eigen::Matrix3d shared = link.by_begin * begin;
    Eigen::Matrix3d covariance = shared * link.by_begin.transpose() + place * link.end +
                                 jitter * link.end_velocity * link.end_velocity.transpose() +
                                 noise.forward * noise.forward * link.forward +
                                 noise.sideways * noise.sideways * link.sideways +
                                 noise.yaw * noise.yaw * link.yaw;
    if (k > 0 && link.follows && !out_[k - 1]) {
      // L(k, k-1) = C(k, k-1) L(k-1, k-1)^-T
      gains_[k] = roots_[k - 1].matrixL().solve(shared.transpose()).transpose();
      covariance -= gains_[k] * gains_[k].transpose();
    }
    roots_[k].compute(covariance);
  }

  const std::vector<bool>& out_;
  std::vector<Eigen::LLT<Eigen::Matrix3d>> roots_;
  std::vector<Eigen::Matrix3d> gains_;
};

/// -2 log likelihood with Student's t for each motion, so that bumps do not pass for noise.
double misfit(const Part& part, const PathNoise& noise, const std::vector<bool>& out) {
  const Innovations innovations(part.links, noise, out);
  Eigen::MatrixXd white = part.residual;
  innovations.apply(white);
  double sum = innovations.log_determinant();
  for (Eigen::Index k = 0; k < white.rows(); k += 3)
    sum += (measurement::kStudentDof + 3.0) *
           std::log1p(measurement::kStudentConsistency * white.middleRows<3>(k).squaredNorm() /
                      measurement::kStudentDof);
  return std::isfinite(sum) ? sum : 1e300;
}

struct Range {
  double PathNoise::*member;
  double low, high;
};
constexpr std::array<Range, 5> kRanges = {
    {{&PathNoise::place, settings::kLeastPlaceScale, settings::kMostPlaceScale},
     {&PathNoise::yaw, settings::kLeastPathNoise, settings::kMostPathNoise},
     {&PathNoise::forward, settings::kLeastPathNoise, settings::kMostPathNoise},
     {&PathNoise::sideways, settings::kLeastPathNoise, settings::kMostPathNoise},
     {&PathNoise::stamp_jitter, settings::kLeastPathJitter_s, settings::kMostPathJitter_s}}};

PathNoise estimate(const Part& part, PathNoise noise, const std::vector<bool>& out) {
  for (int sweep = 0; sweep < settings::kPathSweeps; ++sweep)
    for (const Range& range : kRanges) {
      const auto at = [&](double log_value) {
        noise.*range.member = std::exp(log_value);
        return misfit(part, noise, out);
      };
      const auto best = boost::math::tools::brent_find_minima(at, std::log(range.low), std::log(range.high),
                                                              settings::kPathNoiseBits);
      noise.*range.member = std::exp(best.first);
    }
  return noise;
}

class Fitter {
 public:
  Fitter(std::span<const PathData> data, const vehicle::EffectList& effects, const Eigen::VectorXd& start,
         const PathFitOptions& options)
      : data_(data), effects_(effects), options_(options) {
    fit_.parameters = start;
    for (const PathData& d : data) {
      parts_.push_back(make_part(d, effects, start));
      out_.emplace_back(parts_.back().links.size(), false);
    }
    fit_.noise.resize(data.size());
  }

  Result<PathFit> run() {
    if (count_links() < settings::kFewestLinks)
      return Error{ErrorCode::empty, "too few scans found their place", "path estimate",
                   "check the recording"};
    for (int round = 0; round < settings::kPathRounds; ++round) {
      linearise_all();
      for (std::size_t d = 0; d < parts_.size(); ++d)
        fit_.noise[d] = estimate(parts_[d], fit_.noise[d], out_[d]);
      for (int i = 0; i < settings::kPathSteps; ++i)
        if (auto error = step()) return *error;
      leave_out();
    }
    linearise_all();
    if (auto error = conclude()) return *error;
    return fit_;
  }

 private:
  [[nodiscard]] std::size_t count_links() const {
    std::size_t count = 0;
    for (const Part& part : parts_) count += part.links.size();
    return count;
  }
  [[nodiscard]] bool is_fixed(Eigen::Index k) const {
    const auto i = static_cast<std::size_t>(k);
    return i < options_.fixed.size() && options_.fixed[i];
  }
  void linearise_all() {
    for (std::size_t d = 0; d < parts_.size(); ++d) linearise(data_[d], effects_, fit_.parameters, parts_[d]);
  }

  struct System {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right_side;
    Eigen::VectorXd scale;  ///< zero for what stays
    std::vector<Eigen::MatrixXd> jacobians, residuals;
  };

  [[nodiscard]] System make_system() const {
    System system;
    const Eigen::Index n = fit_.parameters.size();
    system.matrix = options_.prior_information;
    system.right_side = -options_.prior_information * fit_.parameters;
    for (std::size_t d = 0; d < parts_.size(); ++d) {
      const Innovations innovations(parts_[d].links, fit_.noise[d], out_[d]);
      system.jacobians.push_back(parts_[d].jacobian);
      system.residuals.push_back(parts_[d].residual);
      innovations.apply(system.jacobians.back());
      innovations.apply(system.residuals.back());
      system.matrix += system.jacobians.back().transpose() * system.jacobians.back();
      system.right_side += system.jacobians.back().transpose() * system.residuals.back();
    }
    system.scale = Eigen::VectorXd::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k)
      if (!is_fixed(k) && system.matrix(k, k) > 0.0) system.scale(k) = 1.0 / std::sqrt(system.matrix(k, k));
    return system;
  }

  /// Scaled to unit diagonal; empty when the motion leaves a direction open.
  [[nodiscard]] std::optional<Eigen::MatrixXd> inverse(const System& system) const {
    Eigen::MatrixXd scaled = system.scale.asDiagonal() * system.matrix * system.scale.asDiagonal();
    for (Eigen::Index k = 0; k < scaled.rows(); ++k)
      if (!(system.scale(k) > 0.0)) scaled(k, k) = 1.0;
    const math::Eigensystem eigen = math::eigensystem(scaled);
    if (!(eigen.values(0) > kMinPivot)) return std::nullopt;
    return system.scale.asDiagonal() * eigen.vectors * eigen.values.cwiseInverse().asDiagonal() *
           eigen.vectors.transpose() * system.scale.asDiagonal();
  }

  [[nodiscard]] Error undetermined() const {
    std::vector<wheels::WheelMotion> motions;
    for (const PathData& data : data_)
      for (std::size_t k = 0; k + 1 < data.scans.size(); ++k)
        motions.push_back(
            wheels::motion_between(data.model->track(), data.scans[k].time, data.scans[k + 1].time, {}));
    return {ErrorCode::refused, "the motion does not determine all parameters", "path estimate",
            classical::record_more(motions)};
  }

  std::optional<Error> step() {
    const System system = make_system();
    const auto covariance = inverse(system);
    if (!covariance) return undetermined();
    fit_.parameters += *covariance * system.right_side;
    linearise_all();
    return std::nullopt;
  }

  /// Bumps and false places end a chain; what follows begins anew.
  void leave_out() {
    const System system = make_system();
    for (std::size_t d = 0; d < parts_.size(); ++d)
      for (std::size_t k = 0; k < parts_[d].links.size(); ++k)
        if (system.residuals[d].middleRows<3>(static_cast<Eigen::Index>(3 * k)).squaredNorm() >
            settings::kPathOutlierSquared)
          out_[d][k] = true;
  }

  [[nodiscard]] math::ClusterRobust robust(const System& system, const Eigen::MatrixXd& inverse) const {
    math::ClusterRobust sums(inverse);
    for (std::size_t d = 0; d < parts_.size(); ++d) {
      for (std::size_t k = 0; k < parts_[d].links.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(3 * k);
        sums.add(parts_[d].links[k].interval.begin,
                 system.jacobians[d].middleRows<3>(row).transpose() * system.residuals[d].middleRows<3>(row));
      }
      sums.end_recording();
    }
    return sums;
  }

  std::optional<Error> conclude() {
    const System system = make_system();
    const auto model = inverse(system);
    if (!model) return undetermined();
    double squares = 0.0;
    for (std::size_t d = 0; d < parts_.size(); ++d) {
      squares += system.residuals[d].squaredNorm();
      for (const bool out : out_[d]) ++(out ? fit_.discarded : fit_.used);
    }
    const double variance =
        std::max(1.0, squares / (3.0 * static_cast<double>(std::max<std::size_t>(fit_.used, 1))));
    fit_.covariance = robust(system, *model).inflated(variance);
    return std::nullopt;
  }

  std::span<const PathData> data_;
  const vehicle::EffectList& effects_;
  const PathFitOptions& options_;
  PathFit fit_;
  std::vector<Part> parts_;
  std::vector<std::vector<bool>> out_;
};

}  // namespace

Result<PathFit> fit_path(std::span<const PathData> data, const vehicle::EffectList& effects,
                         const Eigen::VectorXd& start, const PathFitOptions& options) {
  return Fitter(data, effects, start, options).run();
}

}  // namespace odomcalib::calib::estimation
