// The joint fit of two wheel radii, track width and sensor pose to N increments, beside Ceres with automatic
// derivatives (Levenberg-Marquardt, dense normal equations: the usual formulation) on the same increments in
// the same run. CPU time; the drive and its observed motion are made before. Ours also estimates the noise,
// weighs outliers down and states a covariance from blocks; Ceres does none of this. Once more with the noise
// given, as Ceres has it. One JSON line for each N. Run build/release/bin/bench_joint REPETITIONS N...
#include <ceres/ceres.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "calib/estimation/joint.hpp"
#include "calib/vehicle/step_context.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/unit/calib/estimation/driven_wheels.hpp"

namespace {

using namespace odomcalib::calib;
using estimation::kNominal;
using estimation::kTruth;

constexpr double kInterval = 0.5;  // s, of an increment
constexpr double kNoise = 1e-3;    // m and rad

/// As a tuple file has it: one sample and one measured motion for each interval.
struct Drive {
  wheels::WheelTrack track;
  std::vector<measurement::SensorPair> pairs;
};

wheels::WheelTrack track_of(std::size_t increments) {
  wheels::WheelTrack track;
  for (std::size_t k = 0; k <= increments; ++k) {
    const double t = kInterval * static_cast<double>(k);
    track.t.push_back(t);
    track.left.push_back(9.0 * std::sin(0.29 * t) + 4.0 * std::sin(0.11 * t));
    track.right.push_back(9.0 * std::sin(0.37 * t) + 4.0 * std::sin(0.13 * t + 1.0));
    track.segment.push_back(0);
  }
  return track;
}

template <typename T>
math::Pose2<T> sensor_motion(const T* p, double left, double right) {
  const math::Pose2<T> mount{p[3], p[4], p[5]};
  const auto arc = wheels::wheel_arc<T>(p[0] * left, p[1] * right, p[2]);
  return math::compose(math::inverse(mount), math::compose(arc, mount));
}

Drive drive_of(std::size_t increments) {
  Drive drive{track_of(increments), {}};
  std::mt19937 engine(3);
  std::normal_distribution<double> noise(0.0, kNoise);
  const Eigen::VectorXd truth = vehicle::to_vector(kTruth);
  for (std::size_t k = 0; k < increments; ++k) {
    const auto& track = drive.track;
    auto motion =
        sensor_motion(truth.data(), track.left[k + 1] - track.left[k], track.right[k + 1] - track.right[k]);
    motion = {motion.x + noise(engine), motion.y + noise(engine), motion.yaw + noise(engine)};
    drive.pairs.push_back(
        {{track.t[k], track.t[k + 1]}, motion, kNoise * kNoise * Eigen::Matrix3d::Identity()});
  }
  return drive;
}

/// White by the stated noise.
struct Residual {
  double left, right;
  math::Pose seen;
  template <typename T>
  bool operator()(const T* p, T* out) const {
    const auto motion = sensor_motion(p, left, right);
    out[0] = (motion.x - seen.x) / kNoise;
    out[1] = (motion.y - seen.y) / kNoise;
    out[2] = math::wrap_angle<T>(motion.yaw - seen.yaw) / kNoise;
    return true;
  }
};

Eigen::VectorXd with_ceres(const Drive& drive) {
  Eigen::VectorXd p = vehicle::to_vector(kNominal);
  ceres::Problem problem;
  for (std::size_t k = 0; k < drive.pairs.size(); ++k)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 3, 6>(new Residual{
                                 drive.track.left[k + 1] - drive.track.left[k],
                                 drive.track.right[k + 1] - drive.track.right[k], drive.pairs[k].motion}),
                             nullptr, p.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return p;
}

template <typename Work>
double milliseconds(const Work& work) {
  const double begin = odomcalib::bench::cpu_ms();
  work();
  return odomcalib::bench::cpu_ms() - begin;
}

std::string list(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + std::to_string(value);
  return "[" + text + "]";
}

/// The largest error of a parameter in units of its standard deviation, which both share.
double farthest(const Eigen::VectorXd& parameters, const Eigen::MatrixXd& covariance) {
  return ((parameters - vehicle::to_vector(kTruth)).array() / covariance.diagonal().array().sqrt())
      .abs()
      .maxCoeff();
}

/// Whether both solvers find the truth within five standard deviations.
bool compare(std::size_t increments, unsigned repetitions) {
  const Drive drive = drive_of(increments);
  const vehicle::DriveModel model(drive.track, vehicle::make_context(drive.track, kNominal));
  const std::vector<measurement::FitData> data = {{&model, drive.pairs}};
  std::vector<double> ours, of_known_noise, theirs;
  double our_error = 0.0, their_error = 0.0;
  for (unsigned k = 0; k < repetitions; ++k) {
    Eigen::VectorXd by_ceres;
    theirs.push_back(milliseconds([&] { by_ceres = with_ceres(drive); }));
    ours.push_back(milliseconds([&] {
      const auto fit = estimation::fit_joint(data, {}, vehicle::to_vector(kNominal));
      if (!fit) std::fprintf(stderr, "bench_joint: %s\n", fit.error().text().c_str()), std::exit(1);
      our_error = farthest(fit.value().parameters, fit.value().covariance);
      their_error = farthest(by_ceres, fit.value().covariance);
    }));
    estimation::FitOptions known;
    known.noise = {measurement::NoiseModel{}};
    of_known_noise.push_back(milliseconds([&] {
      if (!estimation::fit_joint(data, {}, vehicle::to_vector(kNominal), known)) std::exit(1);
    }));
  }
  std::printf(
      "{\"increments\": %zu, \"odomcalib_ms\": %s, \"odomcalib_known_noise_ms\": %s, \"ceres_ms\": %s, "
      "\"odomcalib_sigmas\": %.2f, "
      "\"ceres_sigmas\": %.2f}\n",
      increments, list(ours).c_str(), list(of_known_noise).c_str(), list(theirs).c_str(), our_error,
      their_error);
  std::fflush(stdout);
  return our_error < 5.0 && their_error < 5.0;
}

}  // namespace

int main(int argc, char** argv) {
  bool good = argc > 2;
  for (int k = 2; k < argc; ++k)
    good &= compare(std::strtoul(argv[k], nullptr, 10),
                    static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10)));
  return good ? 0 : 1;
}
