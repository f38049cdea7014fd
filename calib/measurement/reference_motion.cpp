#include "calib/measurement/reference_motion.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/matching/point_to_line.hpp"
#include "calib/matching/surface.hpp"
#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

math::Pose scaled(const math::Pose& motion, double factor) {
  const math::Pose twist = log_se2(motion);
  return math::exp_se2<double>(twist.x * factor, twist.y * factor, twist.yaw * factor);
}

math::Pose pose_of(const PoseSample& sample) { return {sample.x, sample.y, sample.yaw}; }

math::Pose step_between(const PoseSample& from, const PoseSample& to) {
  math::Pose step = between(pose_of(from), pose_of(to));
  step.yaw = math::wrap_angle(step.yaw);
  return step;
}

/// Puts short motions together to longer ones.
class Collector {
 public:
  void add(double begin, double end, const math::Pose& step) {
    if (!open_) open_ = ReferenceMotion{begin, begin, {}};
    open_->motion = compose(open_->motion, step);
    open_->end = end;
    if (end - open_->begin >= settings::kFirstLookStep_s) close();
  }
  /// The next motion does not follow.
  void interrupt() { open_.reset(); }
  [[nodiscard]] std::vector<ReferenceMotion> take() { return std::move(done_); }

 private:
  void close() {
    done_.push_back(*open_);
    open_.reset();
  }
  std::optional<ReferenceMotion> open_;
  std::vector<ReferenceMotion> done_;
};

ReferenceMotions of_poses(const Recording& recording, std::size_t most) {
  Collector collector;
  const auto& poses = recording.poses;
  for (std::size_t k = 1; k < std::min(poses.size(), most); ++k) {
    if (poses[k].t - poses[k - 1].t > ingest::settings::kMaxGap_s)
      collector.interrupt();
    else
      collector.add(poses[k - 1].t, poses[k].t, step_between(poses[k - 1], poses[k]));
  }
  return {collector.take(), 0, 0};
}

class ScanFollower {
 public:
  explicit ScanFollower(const Recording& recording)
      : recording_(recording), range_noise_(matching::estimate_range_noise(recording.scans)) {}

  ReferenceMotions run(std::size_t most) {
    const auto& scans = recording_.scans;
    auto before = prepared(0);
    for (std::size_t k = 1; k < std::min(scans.size(), most); ++k) {
      auto next = prepared(k);
      follow(*before, *next, time_of(k - 1), time_of(k));
      before = std::move(next);
    }
    found_.motions = collector_.take();
    return std::move(found_);
  }

 private:
  [[nodiscard]] double time_of(std::size_t k) const {
    return recording_.scans[k].t + matching::reference_time(recording_.scans[k]);
  }

  /// The sweep moves as the motion before it.
  [[nodiscard]] std::unique_ptr<matching::MatchReference> prepared(std::size_t k) const {
    const double middle = matching::reference_time(recording_.scans[k]);
    const matching::BeamMotion motion = [this, middle](double t) { return scaled(velocity_, t - middle); };
    return std::make_unique<matching::MatchReference>(
        matching::make_surface(recording_.scans[k], motion, range_noise_), range_noise_);
  }

  void follow(const matching::MatchReference& from, const matching::MatchReference& to, double begin,
              double end) {
    const double step = end - begin;
    if (!(step > 0.0) || step > ingest::settings::kMaxGap_s) return lose();
    matching::MatchOptions options;
    options.range_noise = range_noise_;
    auto match = match_point_to_line(from, to.surface(), scaled(velocity_, step), options);
    if (!match.is_usable()) match = match_point_to_line(from, to.surface(), {}, options);
    if (!match.is_usable()) return lose();
    ++found_.matched;
    velocity_ = scaled(match.motion, 1.0 / step);
    collector_.add(begin, end, match.motion);
  }

  void lose() {
    ++found_.unmatched;
    velocity_ = {};
    collector_.interrupt();
  }

  const Recording& recording_;
  double range_noise_;
  math::Pose velocity_;  ///< motion in one second
  Collector collector_;
  ReferenceMotions found_;
};

}  // namespace

ReferenceMotions reference_motions(const Recording& recording, std::size_t most) {
  if (!recording.poses.empty()) return of_poses(recording, most);
  if (recording.scans.size() < 2) return {};
  return ScanFollower(recording).run(most);
}

}  // namespace odomcalib::calib::measurement
