#include "calib/report/sample_pairs.hpp"

#include "calib/selection/drive_error.hpp"

namespace odomcalib::calib::report {
namespace {

std::array<double, 3> numbers(const math::Pose& motion) {
  return {motion.x, motion.y, math::wrap_angle(motion.yaw)};
}

}  // namespace

std::vector<measurement::SamplePair> sample_pairs(const measurement::Dataset& dataset,
                                                  const vehicle::EffectList& effects,
                                                  const estimation::FitResult& fit) {
  const math::Pose mount = vehicle::to_base(vehicle::as_span(fit.parameters)).mount;
  const Eigen::VectorXd nominal = selection::with_wheels(fit.parameters, effects, dataset.nominal);
  std::vector<measurement::SamplePair> samples;
  for (std::size_t i = 0; i < dataset.data.size(); ++i) {
    const vehicle::Trajectory odometry =
        dataset.data[i].model->trajectory(vehicle::as_span(nominal), effects);
    for (const measurement::SensorPair& pair : dataset.data[i].pairs) {
      const auto& [begin, end] = pair.interval;
      samples.push_back({i, begin, end, numbers(between(odometry.at(begin), odometry.at(end))),
                         numbers(conjugate(pair.motion, inverse(mount)))});
    }
  }
  return samples;
}

}  // namespace odomcalib::calib::report
