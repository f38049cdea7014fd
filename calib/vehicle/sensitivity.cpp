#include "calib/vehicle/sensitivity.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <optional>

#include "calib/math/last_value.hpp"
#include "calib/math/vector2.hpp"
#include "calib/vehicle/step_twist.hpp"

namespace odomcalib::calib::vehicle {
namespace {

using Chunk = Eigen::Matrix<double, 3, kJetSize>;

template <int N>
using SmallJet = ceres::Jet<double, N>;

template <int N>
Eigen::Matrix<double, 3, N> derivatives_of(const math::Pose2<SmallJet<N>>& pose) {
  Eigen::Matrix<double, 3, N> rows;
  rows << pose.x.v.transpose(), pose.y.v.transpose(), pose.yaw.v.transpose();
  return rows;
}

/// d exp(w) / d w.
Eigen::Matrix3d exp_derivative(const math::Pose& w) {
  using J = SmallJet<3>;
  return derivatives_of<3>(math::exp_se2<J>(J(w.x, 0), J(w.y, 1), J(w.yaw, 2)));
}

/// Derivatives of m = mount^-1 * base * mount: columns base x, y, yaw, mount x, y, yaw.
Eigen::Matrix<double, 3, 6> conjugate_derivative(const math::Pose& base, const math::Pose& mount) {
  using J = SmallJet<6>;
  return derivatives_of<6>(math::conjugate<J>({J(base.x, 0), J(base.y, 1), J(base.yaw, 2)},
                                              {J(mount.x, 3), J(mount.y, 4), J(mount.yaw, 5)}));
}

/// One end of an interval on the trajectory.
struct End {
  std::size_t step = 0;
  PartOfStep::Weights<double> weights{};  ///< of the twist since the step's begin
  /// Derivative of the motion since the step's begin, by that twist.
  Eigen::Matrix3d by_twist = Eigen::Matrix3d::Zero();
  math::Pose pose;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< by encoder time, in room axes
};

End end_at(const wheels::WheelTrack& track, const Trajectory& along, double sensor_time) {
  using J = SmallJet<1>;
  const double time = along.encoder_time(sensor_time);
  End end;
  end.step = track.interval_at(time);
  const double begin = track.t[end.step];
  const J share = (J(time, 0) - begin) / (track.t[end.step + 1] - begin);
  const PartOfStep part(track, along.twists(), end.step);
  const math::Pose2<J> w = part.twist(share);
  const math::Pose& p = along.poses()[end.step];
  const auto pose = math::compose<J>({J(p.x), J(p.y), J(p.yaw)}, math::exp_se2<J>(w.x, w.y, w.yaw));
  end.weights = part.weights(share.a);
  end.by_twist = exp_derivative({w.x.a, w.y.a, w.yaw.a});
  end.pose = {pose.x.a, pose.y.a, pose.yaw.a};
  end.velocity = derivatives_of<1>(pose);
  return end;
}

/// Derivative of the base motion from `begin` to `end` by the pose `here` (x, y in room axes, yaw), when
/// everything after `here` is carried along rigidly.
Eigen::Matrix3d carried(const math::Pose& begin, const math::Pose& here, const math::Pose& end) {
  const double c = std::cos(begin.yaw), s = std::sin(begin.yaw);
  const double lever_x = -(end.y - here.y), lever_y = end.x - here.x;
  Eigen::Matrix3d m;
  m << c, s, c * lever_x + s * lever_y, -s, c, c * lever_y - s * lever_x, 0.0, 0.0, 1.0;
  return m;
}

/// How the twist of a step changes a base motion: `part` of the twist from the pose `from` on leads to `to`.
Eigen::Matrix3d twist_to_motion(const math::Pose& begin, const math::Pose& from, const math::Pose& to,
                                const math::Pose& end, const Eigen::Matrix3d& part) {
  return carried(begin, to, end) * math::rotation_about_z(from.yaw) * part;
}

/// Parameters as jets; those in [first, first + kJetSize) carry derivatives.
std::vector<Jet> seed(std::span<const double> parameters, std::size_t first) {
  std::vector<Jet> jets;
  jets.reserve(parameters.size());
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const bool active = k >= first && k < first + kJetSize;
    jets.push_back(active ? Jet(parameters[k], static_cast<int>(k - first)) : Jet(parameters[k]));
  }
  return jets;
}

/// Motions whose steps' derivatives are held at a time; those of a whole drive would be a third of its
/// memory.
constexpr std::size_t kMotions = 64;

/// Tick intervals from one to before another.
struct Steps {
  std::size_t begin = std::numeric_limits<std::size_t>::max(), end = 0;
  void take(std::size_t first, std::size_t count) {
    begin = std::min(begin, first);
    end = std::max(end, first + count);
  }
};

/// Those that matter to some motions.
template <typename Path>
Steps steps_of(std::span<const Path> paths) {
  Steps steps;
  for (const Path& path : paths) steps.take(path.first, path.by_twist.size());
  return steps;
}

/// Derivatives of the twists of some steps by the parameters that carry them.
class TwistDerivatives {
 public:
  TwistDerivatives(Steps steps, std::span<const StepContext> contexts, const std::vector<Jet>& jets,
                   const PlacedEffects& effects)
      : first_(steps.begin) {
    of_step_.reserve(steps.end - steps.begin);
    for (std::size_t k = steps.begin; k < steps.end; ++k)
      of_step_.push_back(derivatives_of<kJetSize>(twist_of<Jet>(contexts[k], jets, effects)));
  }
  const Chunk& operator[](std::size_t step) const { return of_step_[step - first_]; }

 private:
  std::size_t first_;
  std::vector<Chunk> of_step_;
};

}  // namespace

/// One interval with all that does not depend on which parameters are wanted.
struct Sensitivity::Path {
  Eigen::Matrix<double, 3, 6> to_sensor;  ///< by base motion, then by mount
  std::size_t first = 0;                  ///< step whose twist matters
  std::vector<Eigen::Matrix3d> by_twist;  ///< base motion by the twist of each step from `first` on
  Eigen::Vector3d by_begin, by_end;       ///< base motion by the encoder times of the ends

  Path(const Trajectory& along, const math::Pose& mount, const End& begin, const End& end,
       const std::vector<Eigen::Matrix3d>& whole_steps);
  /// @param by_part base motion by the twist of the part of the step that lies before one of its ends
  void add(const End& at, const Eigen::Matrix3d& by_part);
  /// Effect of delays of both ends.
  [[nodiscard]] Chunk by_delays(const Jet& at_begin, const Jet& at_end) const {
    return -by_begin * at_begin.v.transpose() - by_end * at_end.v.transpose();
  }
};

Sensitivity::Path::Path(const Trajectory& along, const math::Pose& mount, const End& begin, const End& end,
                        const std::vector<Eigen::Matrix3d>& whole_steps) {
  const math::Pose &b = begin.pose, &e = end.pose;
  to_sensor = conjugate_derivative(between(b, e), mount);
  by_end = math::rotation_about_z(-b.yaw) * end.velocity;
  by_begin = -carried(b, b, e) * begin.velocity;
  first = begin.step > 0 ? begin.step - 1 : 0;
  const std::size_t last = std::min(end.step + 1, along.twists().size() - 1);
  by_twist.assign(last - first + 1, Eigen::Matrix3d::Zero());
  for (std::size_t k = begin.step; k < end.step; ++k)
    by_twist[k - first] = twist_to_motion(b, along.poses()[k], along.poses()[k + 1], e, whole_steps[k]);
  add(end, twist_to_motion(b, along.poses()[end.step], e, e, end.by_twist));
  add(begin, -twist_to_motion(b, along.poses()[begin.step], b, e, begin.by_twist));
}

void Sensitivity::Path::add(const End& at, const Eigen::Matrix3d& by_part) {
  by_twist[at.step - first] += at.weights.own * by_part;
  if (at.step > first) by_twist[at.step - first - 1] += at.weights.before * by_part;
  if (at.step + 1 < first + by_twist.size()) by_twist[at.step - first + 1] += at.weights.after * by_part;
}

Sensitivity::Sensitivity(const DriveModel& model, const Trajectory& along,
                         std::span<const Interval> intervals)
    : model_(model), along_(along), intervals_(intervals.begin(), intervals.end()) {
  std::vector<Eigen::Matrix3d> whole_steps;
  whole_steps.reserve(along.twists().size());
  for (const math::Pose& w : along.twists()) whole_steps.push_back(exp_derivative(w));
  const math::Pose mount = to_base(along.parameters()).mount;
  paths_.reserve(intervals.size());
  math::LastValue end([&](double time) { return end_at(model.track(), along, time); });
  for (const Interval& i : intervals) {
    const End begin = end(i.begin);
    paths_.emplace_back(along, mount, begin, end(i.end), whole_steps);
  }
}

Sensitivity::~Sensitivity() = default;

Eigen::MatrixXd Sensitivity::by_all() const { return by(along_.parameters(), along_.effects(), 0); }

Eigen::MatrixXd Sensitivity::by_more(const EffectList& effects, std::span<const double> parameters) const {
  const More more = with(effects, parameters);
  return by(more.parameters, more.effects, along_.parameters().size());
}

Sensitivity::More Sensitivity::with(const EffectList& effects, std::span<const double> parameters) const {
  EffectList all = along_.effects().list();
  all.insert(all.end(), effects.begin(), effects.end());
  std::vector<double> values(along_.parameters().begin(), along_.parameters().end());
  values.insert(values.end(), parameters.begin(), parameters.end());
  return {PlacedEffects(all, kBaseCount), std::move(values)};
}

std::vector<StepResponse> Sensitivity::by_steps(const EffectList& effects,
                                                std::span<const double> parameters) const {
  const More more = with(effects, parameters);
  const std::vector<Jet> jets = seed(more.parameters, along_.parameters().size());
  const auto count = parameters.size();
  std::vector<StepResponse::Span> spans;
  Eigen::Index steps = 0;
  for (const Path& path : paths_) {
    spans.push_back({path.first, path.by_twist.size()});
    steps += static_cast<Eigen::Index>(path.by_twist.size());
  }
  std::vector<Eigen::Matrix3Xd> rows(count, Eigen::Matrix3Xd(3, steps));
  Eigen::Index column = 0;
  for (std::size_t begin = 0; begin < paths_.size(); begin += kMotions) {
    const auto some = std::span<const Path>(paths_).subspan(begin, std::min(kMotions, paths_.size() - begin));
    const TwistDerivatives twists(steps_of(some), model_.context(), jets, more.effects);
    for (const Path& path : some)
      for (std::size_t k = 0; k < path.by_twist.size(); ++k, ++column)
        for (std::size_t p = 0; p < count; ++p)
          rows[p].col(column) = path.to_sensor.leftCols<3>() *
                                (path.by_twist[k] * twists[path.first + k].col(static_cast<Eigen::Index>(p)));
  }
  std::vector<StepResponse> responses;
  responses.reserve(count);
  for (auto& of_parameter : rows) responses.emplace_back(spans, std::move(of_parameter));
  return responses;
}

/// Some motions at a time, whose functions stay in the fastest memory.
Eigen::MatrixXd StepResponse::by_coefficients(const Eigen::MatrixXd& functions,
                                              const Eigen::RowVectorXd& mean) const {
  Eigen::MatrixXd all(static_cast<Eigen::Index>(3 * spans_.size()), functions.cols()), near;
  Eigen::Index column = 0;
  for (std::size_t begin = 0; begin < spans_.size(); begin += kMotions) {
    const std::size_t end = std::min(begin + kMotions, spans_.size());
    Steps steps;
    for (std::size_t i = begin; i < end; ++i) steps.take(spans_[i].first, spans_[i].count);
    near = functions.middleRows(static_cast<Eigen::Index>(steps.begin),
                                static_cast<Eigen::Index>(steps.end - steps.begin));
    if (mean.size() > 0) near.rowwise() -= mean;
    for (std::size_t i = begin; i < end; ++i) {
      const auto count = static_cast<Eigen::Index>(spans_[i].count);
      all.middleRows<3>(static_cast<Eigen::Index>(3 * i)).noalias() =
          rows_.middleCols(column, count)
              .lazyProduct(near.middleRows(static_cast<Eigen::Index>(spans_[i].first - steps.begin), count));
      column += count;
    }
  }
  return all;
}

Eigen::MatrixXd Sensitivity::by(std::span<const double> parameters, const PlacedEffects& effects,
                                std::size_t first) const {
  Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(3 * paths_.size()),
                           static_cast<Eigen::Index>(parameters.size() - first));
  if (paths_.empty()) return jacobian;
  const double middle = middle_of(model_.track());
  for (std::size_t chunk = first; chunk < parameters.size(); chunk += kJetSize) {
    const auto count = static_cast<Eigen::Index>(std::min<std::size_t>(kJetSize, parameters.size() - chunk));
    const std::vector<Jet> jets = seed(parameters, chunk);
    std::optional<TwistDerivatives> twists;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (i % kMotions == 0)
        twists.emplace(
            steps_of(std::span<const Path>(paths_).subspan(i, std::min(kMotions, paths_.size() - i))),
            model_.context(), jets, effects);
      const Path& path = paths_[i];
      Chunk base = path.by_delays(effects.delay<Jet>(intervals_[i].begin - middle, jets),
                                  effects.delay<Jet>(intervals_[i].end - middle, jets));
      for (std::size_t k = 0; k < path.by_twist.size(); ++k)
        base.noalias() += path.by_twist[k] * (*twists)[path.first + k];
      Chunk rows = path.to_sensor.leftCols<3>() * base;
      for (Eigen::Index m = 0; m < 3; ++m) {
        const auto column = static_cast<Eigen::Index>(kMountX) + m - static_cast<Eigen::Index>(chunk);
        if (column >= 0 && column < kJetSize) rows.col(column) += path.to_sensor.col(3 + m);
      }
      jacobian.block(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(chunk - first), 3, count) =
          rows.leftCols(count);
    }
  }
  return jacobian;
}

}  // namespace odomcalib::calib::vehicle
