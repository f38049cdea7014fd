#include "calib/validation/evaluation_window.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/math/vector2.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {
namespace {

/// How much of its kind a pair is: m or rad, signed; nullopt when it is of another kind.
std::optional<double> amount_of(WindowKind kind, const math::Pose& base) {
  const double turn = std::abs(base.yaw);
  const double length = std::hypot(base.x, base.y);
  if (turn < settings::kStanding && length < settings::kStanding) return 0.0;
  if (kind == WindowKind::straight)
    return turn < settings::kStraightest * length + settings::kStanding
               ? std::optional(std::copysign(length, base.x))
               : std::nullopt;
  return length < settings::kOnTheSpot * turn + settings::kStanding ? std::optional(base.yaw) : std::nullopt;
}

/// Sensor poses along the chain in the frame of its begin, each with its pair's noise.
class Chain {
 public:
  explicit Chain(const measurement::NoiseModel& noise) : noise_(noise) {}

  void add(const measurement::SensorPair& pair) {
    const double duration = std::max(pair.interval.end - pair.interval.begin, 1e-3);
    const double c = std::cos(end_.yaw);
    const double s = std::sin(end_.yaw);
    measurement::PairState state;
    state.heading = end_.yaw;
    state.begin_velocity = Eigen::Vector3d(c * pair.motion.x - s * pair.motion.y,
                                           s * pair.motion.x + c * pair.motion.y, pair.motion.yaw) /
                           duration;
    state.end_velocity = state.begin_velocity;
    end_ = compose(end_, pair.motion);
    links_.push_back({&pair, state, end_});
  }

  [[nodiscard]] const math::Pose& end() const { return end_; }

  /// Covariance of the base's motion over the whole chain, in the base's frame at the begin.
  [[nodiscard]] Eigen::Matrix3d covariance(const math::Pose& mount) const {
    const math::Pose base = compose(end_, inverse(mount));
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const Eigen::Matrix3d a = lever(base, links_[k].after);
      sum += a * full_covariance(*links_[k].pair, links_[k].state, noise_) * a.transpose();
      if (k == 0) continue;
      const Link& before = links_[k - 1];
      const Eigen::Matrix3d cross =
          a * neighbour_covariance(*before.pair, before.state, *links_[k].pair, links_[k].state, noise_) *
          lever(base, before.after).transpose();
      sum += cross + cross.transpose();
    }
    return in_axes_of_base(sum, mount);
  }

  /// The same of a chain whose ends are known otherwise, as well as `ends` says: x, y, yaw of the sensor's
  /// motion. What is left is what the wheels and the stamps do in between.
  [[nodiscard]] Eigen::Matrix3d covariance(const math::Pose& mount, const Eigen::Matrix3d& ends) const {
    const math::Pose base = compose(end_, inverse(mount));
    const Eigen::Matrix3d at_end = lever(base, end_);
    Eigen::Matrix3d sum = at_end * ends * at_end.transpose();
    for (const Link& link : links_) {
      const Eigen::Matrix3d a = lever(base, link.after);
      sum += a * covariance_of_wheels(link).asDiagonal() * a.transpose();
    }
    const Eigen::Vector3d begin = lever(base, links_.front().after) * links_.front().state.begin_velocity;
    const Eigen::Vector3d end = at_end * links_.back().state.end_velocity;
    sum += noise_.stamp_jitter * noise_.stamp_jitter * (begin * begin.transpose() + end * end.transpose());
    return in_axes_of_base(sum, mount);
  }

 private:
  struct Link {
    const measurement::SensorPair* pair;
    measurement::PairState state;
    math::Pose after;
  };
  static Eigen::Matrix3d in_axes_of_base(const Eigen::Matrix3d& covariance, const math::Pose& mount) {
    const Eigen::Matrix3d turn = math::rotation_about_z(mount.yaw);
    return turn * covariance * turn.transpose();
  }
  /// Errors that neighbours take back, as those of the scan that they share, are none of the wheels'.
  [[nodiscard]] Eigen::Vector3d covariance_of_wheels(const Link& link) const {
    const double way = noise_.process_translation, turn = noise_.process_rotation;
    const Eigen::Vector3d all = base_covariance(*link.pair, link.state, noise_).diagonal();
    Eigen::Vector3d wheels(way * way, way * way, turn * turn);
    for (Eigen::Index k = 0; k < wheels.size(); ++k) {
      const double lasting = 1.0 + 2.0 * noise_.correlation.at(static_cast<std::size_t>(k));
      wheels(k) = std::min(wheels(k), std::max(lasting, 0.0) * all(k));
    }
    return wheels;
  }
  /// How an error made at `at` moves the end: a heading error swings everything that comes after it.
  static Eigen::Matrix3d lever(const math::Pose& end, const math::Pose& at) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
    a(0, 2) = -(end.y - at.y);
    a(1, 2) = end.x - at.x;
    return a;
  }
  const measurement::NoiseModel& noise_;
  std::vector<Link> links_;
  math::Pose end_;
};

/// The wheels say nothing of how well places are known.
math::Pose at_rest(double /*time*/) { return {}; }

/// By the places of the scans about both ends.
std::optional<measurement::PlacedMotion> motion_by_places(const measurement::FitData& data,
                                                          const vehicle::Interval& interval,
                                                          const measurement::PathOfWheels& wheels) {
  const double reach = std::min(measurement::kMeanReach, 0.5 * (interval.end - interval.begin));
  const auto begin = mean_place(data.places, interval.begin, wheels, reach);
  const auto end = mean_place(data.places, interval.end, wheels, reach);
  return begin && end ? std::optional(motion_between(*begin, *end)) : std::nullopt;
}

/// One recording's windows, found from left to right.
class Finder {
 public:
  /// @param whole of a window: s of open loop, m of way; other kinds have their own end
  Finder(WindowKind kind, double whole, const measurement::FitData& data, std::size_t recording,
         std::span<const std::size_t> folds, const std::vector<bool>& trusted, std::size_t first,
         const measurement::NoiseModel& noise, const math::Pose& mount)
      : kind_(kind),
        whole_(whole),
        data_(data),
        pairs_(data.pairs),
        recording_(recording),
        folds_(folds),
        trusted_(trusted),
        first_(first),
        noise_(noise),
        mount_(mount) {}

  std::vector<EvaluationWindow> run() {
    for (std::size_t begin = 0; begin < pairs_.size();) {
      const bool is_window = kind_ == WindowKind::open_loop || kind_ == WindowKind::way;
      const std::size_t after = is_window ? window_from(begin) : run_from(begin);
      begin = std::max(after, begin + 1);
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] bool joined(std::size_t begin, std::size_t k) const {
    return folds_[k] == folds_[begin] && trusted_[first_ + k] && (k == begin || pairs_[k].follows_previous);
  }

  [[nodiscard]] double way_of(std::size_t k) const {
    const math::Pose base = conjugate(pairs_[k].motion, inverse(mount_));
    return std::hypot(base.x, base.y);
  }

  /// Windows overlap by half. @return where the next one begins
  std::size_t window_from(std::size_t begin) {
    std::size_t half = begin + 1;
    std::size_t k = begin;
    double way = 0.0;
    for (; k < pairs_.size() && joined(begin, k); ++k) {
      way += way_of(k);
      const double elapsed = pairs_[k].interval.end - pairs_[begin].interval.begin;
      const double so_far = kind_ == WindowKind::way ? way : elapsed;
      if (so_far < whole_ / 2.0) half = k + 1;
      if (so_far < whole_) continue;
      keep(begin, k, kind_ == WindowKind::way ? way : 1.0);
      return half;
    }
    return k;
  }

  /// The longest run of one kind and direction, cut at a metre or a full turn. @return where the next one
  /// begins
  std::size_t run_from(std::size_t begin) {
    const double full = kind_ == WindowKind::straight ? 1.0 : 2.0 * math::kPi;
    const double least =
        kind_ == WindowKind::straight ? settings::kShortestStraight_m : settings::kSmallestTurn_rad;
    double sum = 0.0;
    std::size_t k = begin;
    for (; k < pairs_.size() && joined(begin, k) && std::abs(sum) < full; ++k) {
      const auto amount = amount_of(kind_, conjugate(pairs_[k].motion, inverse(mount_)));
      if (!amount || *amount * sum < 0.0) break;
      sum += *amount;
    }
    if (std::abs(sum) >= least)
      keep(begin, k - 1, std::abs(sum) / (kind_ == WindowKind::straight ? 1.0 : 2.0 * math::kPi));
    return k;
  }

  void keep(std::size_t first, std::size_t last, double amount) {
    Chain chain(noise_);
    for (std::size_t k = first; k <= last; ++k) chain.add(pairs_[k]);
    EvaluationWindow window;
    window.recording = recording_;
    window.first = first;
    window.last = last;
    window.fold = folds_[first];
    const double since = pairs_[first].interval.begin - pairs_.front().interval.begin;
    window.block =
        1000 * recording_ + static_cast<std::size_t>(std::max(0.0, since / settings::kWindowBlock_s));
    window.amount = amount;
    window.interval = {pairs_[first].interval.begin, pairs_[last].interval.end};
    window.chained = chain.end();
    const auto ends = motion_by_places(data_, window.interval, at_rest);
    window.covariance = ends ? chain.covariance(mount_, ends->covariance) : chain.covariance(mount_);
    found_.push_back(window);
  }

  WindowKind kind_;
  double whole_;
  const measurement::FitData& data_;
  std::span<const measurement::SensorPair> pairs_;
  std::size_t recording_;
  std::span<const std::size_t> folds_;
  const std::vector<bool>& trusted_;  ///< of all recordings
  std::size_t first_;                 ///< pair of this one among them
  const measurement::NoiseModel& noise_;
  math::Pose mount_;
  std::vector<EvaluationWindow> found_;
};

std::vector<EvaluationWindow> windows_of(WindowKind kind, double whole,
                                         std::span<const measurement::FitData> data,
                                         const std::vector<std::size_t>& folds,
                                         const estimation::FitResult& fit, const std::vector<bool>& trusted) {
  const math::Pose mount = vehicle::to_base(vehicle::as_span(fit.parameters)).mount;
  std::vector<EvaluationWindow> all;
  if (!hold_out(folds)) return all;
  std::size_t first = 0;
  for (std::size_t d = 0; d < data.size(); ++d) {
    const std::size_t count = data[d].pairs.size();
    const auto found = Finder(kind, whole, data[d], d, std::span(folds).subspan(first, count), trusted, first,
                              fit.noise[d], mount)
                           .run();
    all.insert(all.end(), found.begin(), found.end());
    first += count;
  }
  return all;
}

}  // namespace

std::vector<bool> trusted_pairs(const estimation::FitResult& fit) { return trusted_pairs(fit, fit); }

std::vector<bool> trusted_pairs(const estimation::FitResult& a, const estimation::FitResult& b) {
  std::vector<bool> trusted;
  for (std::size_t k = 0; k < std::min(a.weights.size(), b.weights.size()); ++k)
    trusted.push_back(std::max(a.weights[k], b.weights[k]) >= settings::kTrustedWeight);
  return trusted;
}

math::Pose measured_motion(const EvaluationWindow& window, const measurement::FitData& data,
                           const measurement::PathOfWheels& wheels) {
  const auto placed = motion_by_places(data, window.interval, wheels);
  return placed ? placed->motion : window.chained;
}

std::vector<bool> measured_pairs(std::span<const measurement::FitData> data, std::vector<bool> trusted) {
  auto flag = trusted.begin();
  for (const measurement::FitData& d : data)
    for (const measurement::SensorPair& pair : d.pairs) {
      *flag = *flag || (mean_place(d.places, pair.interval.begin, at_rest) &&
                        mean_place(d.places, pair.interval.end, at_rest));
      ++flag;
    }
  return trusted;
}

std::vector<EvaluationWindow> find_windows(WindowKind kind, std::span<const measurement::FitData> data,
                                           const std::vector<std::size_t>& folds,
                                           const estimation::FitResult& fit,
                                           const std::vector<bool>& trusted) {
  return windows_of(kind, settings::kHorizon_s, data, folds, fit, trusted);
}

std::vector<EvaluationWindow> find_windows_of_way(double length, std::span<const measurement::FitData> data,
                                                  const std::vector<std::size_t>& folds,
                                                  const estimation::FitResult& fit,
                                                  const std::vector<bool>& trusted) {
  return windows_of(WindowKind::way, length, data, folds, fit, trusted);
}

}  // namespace odomcalib::calib::validation
