#include "calib/odometry/predict.hpp"

#include <cstddef>

#include "calib/ingest/even_stamps.hpp"
#include "calib/odometry/dead_reckoning.hpp"
#include "calib/odometry/odometry.hpp"
#include "calib/vehicle/step_context.hpp"

namespace odomcalib::calib::odometry {

std::vector<PoseSample> predict(const Recording& recording, const Calibration& calibration) {
  std::vector<PoseSample> poses;
  Recording counted;
  counted.robot = recording.robot;
  counted.ticks = recording.ticks;
  if (const auto even = ingest::even_ticks(recording)) set_stamps(counted.ticks, even->t);
  const wheels::WheelTrack track = wheels::wheel_track_from_ticks(counted);
  if (track.empty()) return poses;
  const DriveClock clock(calibration, track.t.front());
  DeadReckoning reckoning(correction_of(calibration, clock.is_known()));
  const vehicle::DriveContext context =
      vehicle::make_context(track, reckoning.base(), covariates_of(reckoning.correction().effects));
  std::size_t k = 0;
  for (std::size_t i = 0; i < recording.ticks.size(); ++i) {
    // Repeated stamps keep the pose.
    for (; k + 1 < track.t.size() && track.t[k + 1] <= counted.ticks[i].t; ++k) {
      vehicle::StepContext interval = context[k];
      interval.t = clock.at(track.t.front() + interval.t);
      reckoning.advance(interval);
    }
    const math::Pose& base = reckoning.pose();
    poses.push_back({recording.ticks[i].t, base.x, base.y, math::wrap_angle(base.yaw)});
  }
  return poses;
}

std::vector<PoseSample> predict_live(const Recording& recording, const Calibration& calibration) {
  Odometry odometry(calibration);
  std::vector<PoseSample> poses;
  poses.reserve(recording.ticks.size());
  for (const TickSample& sample : recording.ticks) poses.push_back(odometry.update(sample));
  return poses;
}

}  // namespace odomcalib::calib::odometry
