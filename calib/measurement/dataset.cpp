#include "calib/measurement/dataset.hpp"

#include <utility>

#include "calib/ingest/recording_check.hpp"
#include "calib/measurement/settings.hpp"
#include "calib/vehicle/step_context.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::measurement {
namespace {

wheels::BaseParameters start_of(const RobotDescription& robot) {
  wheels::BaseParameters base = wheels::nominal_base(robot);
  if (!(base.left_radius > 0.0)) base.left_radius = settings::kUnknownRadius_m;
  if (!(base.right_radius > 0.0)) base.right_radius = settings::kUnknownRadius_m;
  if (!(base.track_width > 0.0)) base.track_width = settings::kUnknownTrack_m;
  return base;
}

Dataset measured_by(Dataset dataset, const Eigen::VectorXd& parameters, const vehicle::EffectList& effects,
                    const PairOptions& options) {
  dataset.data.clear();
  dataset.pair_sets.clear();
  for (std::size_t i = 0; i < dataset.models.size(); ++i) {
    const vehicle::DriveModel& model = *dataset.models[i];
    dataset.pair_sets.push_back(
        build_pairs(dataset.recordings[i], model, vehicle::as_span(parameters), effects, options));
    dataset.data.push_back({&model, dataset.pair_sets.back().pairs});
  }
  return dataset;
}

Result<wheels::WheelTrack> track_of(const Recording& recording) {
  wheels::WheelTrack track = recording.increments.empty()
                                 ? finely_sampled(wheels::wheel_track_from_ticks(recording))
                                 : wheels::wheel_track_from_increments(recording);
  if (track.empty())
    return Error{ErrorCode::empty, "tick times do not advance", recording.name,
                 "check the controller's clock"};
  return track;
}

template <typename IsTaken>
std::vector<wheels::WheelMotion> motions_of(std::span<const FitData> data, double delay, IsTaken is_taken) {
  std::vector<wheels::WheelMotion> motions;
  for (const FitData& d : data) {
    const wheels::WheelTrack& track = d.model->track();
    for (const SensorPair& pair : d.pairs)
      if (is_taken(pair))
        motions.push_back(
            motion_between(track, pair.interval.begin - delay, pair.interval.end - delay, pair.motion));
  }
  return motions;
}

}  // namespace

bool Dataset::reference_is_base() const { return !has_motions_alone() && !recordings.front().poses.empty(); }

bool Dataset::reference_is_scans() const {
  return !has_motions_alone() && !reference_is_base() && !recordings.front().scans.empty();
}

std::vector<bool> Dataset::fixed() const {
  std::vector<bool> fixed(vehicle::kBaseCount, false);
  for (const auto k : {vehicle::kMountX, vehicle::kMountY, vehicle::kMountYaw})
    fixed[k] = reference_is_base() && !reference_sits_anywhere;
  return fixed;
}

bool Dataset::is_measured_with(const Eigen::VectorXd& parameters) const {
  return parameters.size() == measured_with.size() &&
         (parameters - measured_with).cwiseAbs().maxCoeff() < settings::kSameParameters;
}

Result<Dataset> open_dataset(const ingest::Recordings& recordings) {
  if (recordings.size() == 0)
    return Error{ErrorCode::usage, "no recording given", "", "name at least one recording"};
  if (auto error = ingest::check_recordings(recordings.view())) return *error;
  Dataset dataset;
  dataset.recordings = recordings;
  dataset.nominal = start_of(recordings.front().robot);
  for (const Recording& recording : recordings.view()) {
    auto track = track_of(recording);
    if (!track) return track.error();
    vehicle::DriveContext context = vehicle::make_context(track.value(), dataset.nominal);
    dataset.models.push_back(
        std::make_shared<const vehicle::DriveModel>(std::move(track).value(), std::move(context)));
  }
  if (dataset.reference_is_base()) dataset.nominal.mount = {};
  return dataset;
}

Dataset with_scans_of(Dataset dataset, const ingest::Recordings& repaired) {
  dataset.recordings = repaired;
  dataset.data.clear();
  dataset.pair_sets.clear();
  dataset.measured_with.resize(0);
  return dataset;
}

Dataset measured_roughly(Dataset dataset) {
  const Eigen::VectorXd nominal = vehicle::to_vector(dataset.nominal);
  dataset.measured_with.resize(0);
  return measured_by(std::move(dataset), nominal, {}, PairOptions{.rough = true});
}

Dataset measured(Dataset dataset, const Eigen::VectorXd& parameters, const vehicle::EffectList& effects) {
  dataset.measured_with = parameters;
  return measured_by(std::move(dataset), parameters, effects, PairOptions{});
}

Dataset located(Dataset dataset, std::span<const std::vector<vehicle::Fix>> fixes,
                const Eigen::VectorXd& parameters, const vehicle::EffectList& effects) {
  for (std::size_t i = 0; i < dataset.models.size(); ++i) {
    wheels::WheelTrack track = dataset.models[i]->track();
    dataset.models[i].reset();  // two of an hour's drive would be half a gigabyte
    dataset.models[i] = std::make_shared<const vehicle::DriveModel>(
        vehicle::DriveModel::located(std::move(track), fixes[i], vehicle::as_span(parameters), effects));
    dataset.data[i].model = dataset.models[i].get();
  }
  return dataset;
}

std::vector<wheels::WheelMotion> wheel_motions(std::span<const FitData> data, double delay) {
  return motions_of(data, delay, [](const SensorPair&) { return true; });
}

std::vector<wheels::WheelMotion> whole_wheel_motions(std::span<const FitData> data, double delay) {
  return motions_of(data, delay, [](const SensorPair& pair) { return !pair.is_partial; });
}

}  // namespace odomcalib::calib::measurement
