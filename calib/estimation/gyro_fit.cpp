#include "calib/estimation/gyro_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/estimation/settings.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/settings.hpp"

namespace odomcalib::calib::estimation {
namespace {

constexpr double kRelativeStep = 1e-6;  ///< of central differences
constexpr double kDegrees = 180.0 / math::kPi;

/// The turn that a gyro has read.
class TurnRead {
 public:
  explicit TurnRead(std::span<const GyroSample> samples) : samples_(samples), angle_(samples.size(), 0.0) {
    for (std::size_t k = 1; k < samples.size(); ++k)
      angle_[k] = angle_[k - 1] +
                  0.5 * (samples[k].yaw_rate + samples[k - 1].yaw_rate) * (samples[k].t - samples[k - 1].t);
  }
  /// rad; nullopt where samples are missing.
  [[nodiscard]] std::optional<double> between(double from, double to) const {
    const auto first = index(from), last = index(to);
    if (!first || !last) return std::nullopt;
    for (std::size_t k = *first; k <= *last; ++k)
      if (samples_[k + 1].t - samples_[k].t > settings::kGyroHole_s) return std::nullopt;
    return at(*last, to) - at(*first, from);
  }
  /// rad/s, at a time that lies between samples.
  [[nodiscard]] double rate(double time) const {
    const auto k = index(time);
    return k ? samples_[*k].yaw_rate : 0.0;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> index(double time) const {
    if (samples_.empty() || time < samples_.front().t || time >= samples_.back().t) return std::nullopt;
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), time,
                                        [](double t, const GyroSample& s) { return t < s.t; });
    return static_cast<std::size_t>(after - samples_.begin()) - 1;
  }
  [[nodiscard]] double at(std::size_t k, double time) const {
    const double dt = time - samples_[k].t, whole = samples_[k + 1].t - samples_[k].t;
    const double slope = (samples_[k + 1].yaw_rate - samples_[k].yaw_rate) / whole;
    return angle_[k] + samples_[k].yaw_rate * dt + 0.5 * slope * dt * dt;
  }

  std::span<const GyroSample> samples_;
  std::vector<double> angle_;
};

/// Turns of one recording, interval by interval: of the pairs, and of what lies between them.
struct Turns {
  std::vector<vehicle::Interval> intervals;
  Eigen::VectorXd wheels;     ///< rad, by the fit
  Eigen::VectorXd lidar;      ///< rad that the lidar saw beyond the wheels; 0 where it saw nothing
  std::vector<bool> is_seen;  ///< by the lidar
  Eigen::MatrixXd jacobian;   ///< of `wheels`, by the parameters
};

void add_unseen(double from, double to, const wheels::WheelTrack& track, Turns& turns) {
  const int count = static_cast<int>(std::floor((to - from) / settings::kBetweenPairs_s));
  for (int k = 0; k < count; ++k) {
    const vehicle::Interval interval{from + k * settings::kBetweenPairs_s,
                                     from + (k + 1) * settings::kBetweenPairs_s};
    if (track.covers(interval.begin, interval.end)) turns.intervals.push_back(interval);
  }
}

Eigen::VectorXd yaws(const vehicle::DriveModel& model, const Eigen::VectorXd& parameters,
                     const vehicle::EffectList& effects, std::span<const vehicle::Interval> intervals) {
  const auto motions = model.predict(vehicle::as_span(parameters), effects, intervals);
  Eigen::VectorXd out(static_cast<Eigen::Index>(motions.size()));
  for (Eigen::Index k = 0; k < out.size(); ++k) out(k) = motions[static_cast<std::size_t>(k)].yaw;
  return out;
}

Eigen::MatrixXd yaw_jacobian(const vehicle::DriveModel& model, const FitResult& fit,
                             const vehicle::EffectList& effects,
                             std::span<const vehicle::Interval> intervals) {
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(intervals.size()), fit.parameters.size());
  for (Eigen::Index i = 0; i < fit.parameters.size(); ++i) {
    if (!(fit.covariance(i, i) > 0.0)) continue;
    const double step = kRelativeStep * std::max(1.0, std::abs(fit.parameters(i)));
    const Eigen::VectorXd unit = step * Eigen::VectorXd::Unit(fit.parameters.size(), i);
    jacobian.col(i) = (yaws(model, fit.parameters + unit, effects, intervals) -
                       yaws(model, fit.parameters - unit, effects, intervals)) /
                      (2.0 * step);
  }
  return jacobian;
}

Turns turns_of(const measurement::FitData& data, const vehicle::EffectList& effects, const FitResult& fit) {
  Turns turns;
  const wheels::WheelTrack& track = data.model->track();
  if (track.empty()) return turns;
  std::vector<double> seen;
  double end = track.t.front() + settings::kBetweenPairs_s;
  for (const measurement::SensorPair& pair : data.pairs) {
    if (pair.interval.begin > end) add_unseen(end, pair.interval.begin, track, turns);
    turns.is_seen.resize(turns.intervals.size(), false);
    seen.resize(turns.intervals.size(), 0.0);
    turns.intervals.push_back(pair.interval);
    turns.is_seen.push_back(true);
    seen.push_back(pair.motion.yaw);
    end = std::max(end, pair.interval.end);
  }
  add_unseen(end, track.t.back() - settings::kBetweenPairs_s, track, turns);
  turns.is_seen.resize(turns.intervals.size(), false);
  turns.wheels = yaws(*data.model, fit.parameters, effects, turns.intervals);
  turns.lidar = Eigen::VectorXd::Zero(turns.wheels.size());
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (turns.is_seen[k]) {
      const auto row = static_cast<Eigen::Index>(k);
      turns.lidar(row) = math::wrap_angle(seen[k] - turns.wheels(row));
    }
  turns.jacobian = yaw_jacobian(*data.model, fit, effects, turns.intervals);
  return turns;
}

/// One interval that the gyro was there for.
struct Row {
  Eigen::Index turn = 0;  ///< index into the turns
  double read = 0.0;      ///< rad
  double duration = 0.0;  ///< s
  double later = 0.0;     ///< what `read` grows by for a second of offset, rad/s
};

std::vector<Row> rows_of(const Turns& turns, const TurnRead& gyro, double offset) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < turns.intervals.size(); ++k) {
    const double begin = turns.intervals[k].begin + offset, end = turns.intervals[k].end + offset;
    const auto read = gyro.between(begin, end);
    if (read)
      rows.push_back({static_cast<Eigen::Index>(k), *read, end - begin, gyro.rate(end) - gyro.rate(begin)});
  }
  return rows;
}

/// read = scale * wheels + bias * duration, by least squares.
struct Line {
  double scale = 0.0, bias = 0.0;
  double share = 0.0;  ///< of the squares of `read` beyond a bias that the turns explain
  double rms = 0.0;    ///< rad, left
};

Line line_of(const Turns& turns, const std::vector<Row>& rows) {
  Eigen::MatrixX2d a(static_cast<Eigen::Index>(rows.size()), 2);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    const Row& row = rows[static_cast<std::size_t>(k)];
    a.row(k) << turns.wheels(row.turn), row.duration;
    b(k) = row.read;
  }
  const Eigen::Vector2d x = math::solve_independent(a, b);
  const double left = (b - a * x).squaredNorm();
  const Eigen::VectorXd duration = a.col(1);
  const double of_bias = (b - duration * (duration.dot(b) / duration.squaredNorm())).squaredNorm();
  return {x(0), x(1), of_bias > 0.0 ? 1.0 - left / of_bias : 0.0,
          std::sqrt(left / static_cast<double>(rows.size()))};
}

double best_offset(const Turns& turns, const TurnRead& gyro) {
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (double offset = -settings::kGyroReach_s; offset <= settings::kGyroReach_s + 1e-9;
       offset += settings::kGyroStep_s) {
    const auto rows = rows_of(turns, gyro, offset);
    if (rows.size() < settings::kFewestGyroTurns) continue;
    const double rms = line_of(turns, rows).rms;
    if (rms < least) {
      least = rms;
      best = offset;
    }
  }
  return best;
}

std::string percent_off(double scale) {
  const int percent = static_cast<int>(std::lround(100.0 * (scale - 1.0)));
  return std::to_string(std::abs(percent)) + " % " + (percent > 0 ? "more" : "less");
}

bool is_about(double scale, double expected) {
  return std::abs(scale / expected - 1.0) < math::settings::kClearSigmas * settings::kGyroScale;
}

/// Fault of a gyro that reads this.
std::optional<std::string> fault_of(const Line& line) {
  if (line.share < settings::kLeastGyroShare)
    return "the gyro is left out: it does not follow the turns of the robot; is it mounted with its axis "
           "upright?";
  const double size = std::abs(line.scale);
  const std::string sign = line.scale < 0.0 ? "its sign is reversed" : "";
  const std::string also = sign.empty() ? "" : sign + ", and ";
  const std::string remedy = "; record yaw_rate in rad/s, counter-clockwise positive";
  if (is_about(size, 1.0))
    return sign.empty() ? std::nullopt : std::optional("the gyro is left out: " + sign + remedy);
  if (is_about(size, kDegrees))
    return "the gyro is left out: " + also + "it is in degrees per second" + remedy;
  if (is_about(size, 1.0 / kDegrees))
    return "the gyro is left out: " + also + "it was converted from degrees twice" + remedy;
  if (size > settings::kGyroFactor || size < 1.0 / settings::kGyroFactor)
    return "the gyro is left out: " + also + "it reads " + std::to_string(size) +
           " times what the robot turns" + remedy;
  return "the gyro is left out: " + also + "it reads " + percent_off(size) +
         " than the robot turns, beyond what gyros are off by; check its range and its scale";
}

/// Rows in the units of their noise: what the gyro reads beyond the wheels, without what the lidar saw of it.
struct System {
  Eigen::MatrixXd of_parameters;
  Eigen::MatrixX3d of_gyro;  ///< scale, bias, offset
  Eigen::VectorXd beyond;
};

/// Slip is in what the lidar and in what the gyro sees beyond the wheels. What both show must count once:
/// the share of the lidar's that the gyro repeats is taken off, as in a block elimination.
struct Noise {
  double repeated = 0.0;                  ///< share
  double of_seen = 0.0, of_unseen = 0.0;  ///< rad, standard deviations
};

double robust_deviation(const std::vector<double>& values) {
  return values.empty() ? 0.0 : math::deviation_about(0.0, values);
}

System system_of(const Turns& turns, const std::vector<Row>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  System system{Eigen::MatrixXd(n, turns.jacobian.cols()), Eigen::MatrixX3d(n, 3), Eigen::VectorXd(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Row& row = rows[static_cast<std::size_t>(k)];
    system.of_parameters.row(k) = turns.jacobian.row(row.turn);
    system.of_gyro.row(k) << turns.wheels(row.turn), row.duration, row.later;
    system.beyond(k) = row.read - turns.wheels(row.turn);
  }
  return system;
}

Noise noise_of(const Turns& turns, const std::vector<Row>& rows, const System& system) {
  const Eigen::VectorXd left =
      system.beyond - system.of_gyro * math::solve_independent(system.of_gyro, system.beyond);
  double both = 0.0, lidar = 0.0;
  std::vector<double> errors;
  for (const Row& row : rows)
    if (turns.is_seen[static_cast<std::size_t>(row.turn)]) errors.push_back(turns.lidar(row.turn));
  const double limit = settings::kOutlier * robust_deviation(errors);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double seen = turns.lidar(rows[k].turn);
    if (seen == 0.0 || std::abs(seen) > limit) continue;
    both += left(static_cast<Eigen::Index>(k)) * seen;
    lidar += seen * seen;
  }
  Noise noise;
  noise.repeated = lidar > 0.0 ? std::clamp(both / lidar, 0.0, 1.0) : 0.0;
  std::vector<double> of_seen, of_unseen;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool seen = turns.is_seen[static_cast<std::size_t>(rows[k].turn)];
    (seen ? of_seen : of_unseen)
        .push_back(left(static_cast<Eigen::Index>(k)) -
                   (seen ? noise.repeated * turns.lidar(rows[k].turn) : 0.0));
  }
  noise.of_seen = robust_deviation(of_seen);
  noise.of_unseen = robust_deviation(of_unseen);
  return noise;
}

/// Rows beyond any noise are taken out: a knock, a hole in the samples that was not seen.
void whiten(const Turns& turns, const std::vector<Row>& rows, const Noise& noise, System& system) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const bool seen = turns.is_seen[static_cast<std::size_t>(rows[k].turn)];
    const double share = seen ? noise.repeated : 0.0;
    const double deviation = seen ? noise.of_seen : noise.of_unseen;
    const double weight = deviation > 0.0 ? 1.0 / deviation : 0.0;
    system.beyond(row) = weight * (system.beyond(row) - share * turns.lidar(rows[k].turn));
    system.of_parameters.row(row) *= weight * (1.0 - share);
    system.of_gyro.row(row) *= weight;
  }
  const Eigen::VectorXd left =
      system.beyond - system.of_gyro * math::solve_independent(system.of_gyro, system.beyond);
  for (Eigen::Index k = 0; k < left.size(); ++k)
    if (std::abs(left(k)) > settings::kOutlier) {
      system.beyond(k) = 0.0;
      system.of_parameters.row(k).setZero();
      system.of_gyro.row(k).setZero();
    }
}

/// Change of parameters and gyro together, and their covariance after it.
struct Update {
  Eigen::VectorXd change;
  Eigen::MatrixXd covariance;
};

Eigen::MatrixXd prior_of(const Eigen::MatrixXd& of_parameters) {
  const Eigen::Index count = of_parameters.rows();
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(count + 3, count + 3);
  prior.topLeftCorner(count, count) = of_parameters;
  prior.diagonal().tail<3>() << settings::kGyroScale * settings::kGyroScale,
      settings::kGyroBias * settings::kGyroBias, settings::kGyroOffset_s * settings::kGyroOffset_s;
  return prior;
}

/// root * root^T is the covariance, of parameters that may be fixed and have units of their own.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd deviations = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd units = deviations.unaryExpr([](double d) { return d > 0.0 ? 1.0 / d : 0.0; });
  const math::Eigensystem eigen = math::eigensystem(units.asDiagonal() * covariance * units.asDiagonal());
  return deviations.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Least squares with a prior that may be singular: what is fixed stays.
/// @param change of the parameters before, about which the prior lies
Update updated(const System& system, const Eigen::MatrixXd& covariance, const Eigen::VectorXd& change) {
  Eigen::MatrixXd rows(system.beyond.size(), covariance.rows() + 3);
  rows << system.of_parameters, system.of_gyro;
  const Eigen::MatrixXd root = root_of(prior_of(covariance));
  const Eigen::MatrixXd seen = rows * root;
  const Eigen::LLT<Eigen::MatrixXd> information(Eigen::MatrixXd::Identity(root.cols(), root.cols()) +
                                                seen.transpose() * seen);
  Update update;
  update.covariance = root * information.solve(root.transpose());
  update.change = Eigen::VectorXd::Zero(rows.cols());
  update.change.head(change.size()) = change;
  update.change += update.covariance * (rows.transpose() * (system.beyond - rows * update.change));
  return update;
}

/// A change of a length that its own deviations do not allow for.
bool contradicts(const Update& update, const Eigen::VectorXd& before, const Eigen::MatrixXd& covariance) {
  for (const Eigen::Index k : {vehicle::kLeftRadius, vehicle::kRightRadius, vehicle::kTrackWidth}) {
    const double gained = covariance(k, k) - update.covariance(k, k);
    const double moved = update.change(k) - before(k);
    if (gained > 0.0 && moved * moved > math::settings::kClearSigmas * math::settings::kClearSigmas * gained)
      return true;
  }
  return false;
}

bool turns_enough(const Turns& turns, const std::vector<Row>& rows) {
  double sum = 0.0;
  for (const Row& row : rows) sum += std::abs(turns.wheels(row.turn));
  return rows.size() >= settings::kFewestGyroTurns && sum > settings::kLeastGyroTurn_rad;
}

/// Finding of one gyro; `change` and `covariance` become what they are with it, unless it is at fault.
GyroFinding weigh(const Turns& turns, const TurnRead& gyro, Eigen::VectorXd& change,
                  Eigen::MatrixXd& covariance) {
  GyroFinding finding;
  finding.offset = best_offset(turns, gyro);
  const auto rows = rows_of(turns, gyro, finding.offset);
  if (!turns_enough(turns, rows)) return finding;
  finding.used = rows.size();
  const Line line = line_of(turns, rows);
  finding.scale = line.scale;
  finding.bias = line.bias;
  if ((finding.fault = fault_of(line))) return finding;
  System system = system_of(turns, rows);
  whiten(turns, rows, noise_of(turns, rows, system), system);
  const Update update = updated(system, covariance, change);
  const Eigen::Index count = change.size();
  finding.scale = 1.0 + update.change(count);
  finding.scale_std = std::sqrt(update.covariance(count, count));
  finding.bias = update.change(count + 1);
  finding.offset -= update.change(count + 2);
  if (contradicts(update, change, covariance)) {
    finding.fault =
        "the gyro is left out: it contradicts what the lidar says of the turns; one of them moved on its "
        "mount, or "
        "measures something else";
    return finding;
  }
  change = update.change.head(count);
  covariance = update.covariance.topLeftCorner(count, count);
  return finding;
}

}  // namespace

GyroFit fit_gyros(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                  const FitResult& fit, std::span<const Recording> recordings) {
  GyroFit witness{std::vector<GyroFinding>(data.size()), fit.parameters, fit.covariance};
  Eigen::VectorXd change = Eigen::VectorXd::Zero(fit.parameters.size());
  for (std::size_t k = 0; k < data.size() && k < recordings.size(); ++k)
    if (!recordings[k].gyro.empty())
      witness.gyros[k] =
          weigh(turns_of(data[k], effects, fit), TurnRead(recordings[k].gyro), change, witness.covariance);
  witness.parameters += change;
  return witness;
}

}  // namespace odomcalib::calib::estimation
