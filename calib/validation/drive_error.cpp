#include "calib/validation/drive_error.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <map>
#include <optional>

#include "calib/math/bootstrap.hpp"
#include "calib/terms/effects/reference_effect.hpp"
#include "calib/validation/evaluation_window.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {
namespace {

constexpr const char* kOpenLoopPosition = "open_loop_10s_position";

constexpr unsigned kDriveErrorSeed = 20010823;

/// The trajectory that a fold's parameters make of a recording answers for each window in it.
template <typename Ask>
std::vector<math::Pose> of_each_window(std::span<const measurement::FitData> data,
                                       const std::vector<EvaluationWindow>& windows,
                                       const std::vector<Eigen::VectorXd>& parameters,
                                       const vehicle::EffectList& effects, const Ask& ask) {
  std::vector<math::Pose> answers(windows.size());
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    for (std::size_t d = 0; d < data.size(); ++d) {
      const auto trajectory = data[d].model->trajectory(vehicle::as_span(parameters[fold]), effects);
      for (std::size_t k = 0; k < windows.size(); ++k)
        if (windows[k].fold == fold && windows[k].recording == d) answers[k] = ask(windows[k], trajectory);
    }
  }
  return answers;
}

/// Motion of the base over each evaluation window by the reference, in the base's frame at its begin. Its
/// places are carried to the ends by wheels: where a stretch begins or ends in an acceleration, wheels that
/// are wrong shift both ends by some per cent of their own error, so these must not be the ones that are
/// judged.
std::vector<math::Pose> measured_motions(std::span<const measurement::FitData> data,
                                         const std::vector<EvaluationWindow>& windows,
                                         const std::vector<Eigen::VectorXd>& parameters,
                                         const vehicle::EffectList& effects) {
  return of_each_window(data, windows, parameters, effects,
                        [&](const EvaluationWindow& window, const vehicle::Trajectory& trajectory) {
                          const math::Pose mount = vehicle::to_base(trajectory.parameters()).mount;
                          return conjugate(measured_motion(window, data[window.recording],
                                                           measurement::path_of_wheels(trajectory)),
                                           inverse(mount));
                        });
}

/// Predicted minus measured motion of each evaluation window, in the base's frame at its begin.
std::vector<math::Pose> errors_of(std::span<const measurement::FitData> data,
                                  const std::vector<EvaluationWindow>& windows,
                                  const std::vector<math::Pose>& measured,
                                  const std::vector<Eigen::VectorXd>& parameters,
                                  const vehicle::EffectList& effects) {
  std::vector<math::Pose> errors = of_each_window(
      data, windows, parameters, effects,
      [](const EvaluationWindow& window, const vehicle::Trajectory& trajectory) {
        return between(trajectory.at(window.interval.begin), trajectory.at(window.interval.end));
      });
  for (std::size_t k = 0; k < errors.size(); ++k)
    errors[k] = {errors[k].x - measured[k].x, errors[k].y - measured[k].y,
                 math::wrap_angle(errors[k].yaw - measured[k].yaw)};
  return errors;
}

/// The number of a pose error that counts, and its variance by the noise model.
enum class Part { along, position, heading };

double square_of(Part part, const math::Pose& e) {
  if (part == Part::along) return e.x * e.x;
  return part == Part::heading ? e.yaw * e.yaw : e.x * e.x + e.y * e.y;
}

double variance_of(Part part, const Eigen::Matrix3d& c) {
  if (part == Part::along) return c(0, 0);
  return part == Part::heading ? c(2, 2) : c(0, 0) + c(1, 1);
}

/// Blocks too few to be drawn from: as of so many independent errors with a normal distribution.
Bounded of_few(double root, std::size_t blocks) {
  const auto freedom = static_cast<double>(blocks);
  const boost::math::chi_squared squares(freedom);
  return {root, root * std::sqrt(freedom / quantile(squares, 0.975)),
          root * std::sqrt(freedom / quantile(squares, 0.025))};
}

Bounded bounded(Part part, std::span<const EvaluationWindow> windows, std::span<const math::Pose> errors) {
  std::map<std::size_t, math::RatioOfSums> by_block;
  math::RatioOfSums total;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const math::RatioOfSums one{square_of(part, errors[k]), windows[k].amount * windows[k].amount};
    by_block[windows[k].block] += one;
    total += one;
  }
  if (by_block.size() < settings::kFewestBlocks) return of_few(total.root(), by_block.size());
  const math::BootstrapInterval interval = bootstrap_root(by_block, kDriveErrorSeed);
  return {total.root(), interval.lower, interval.upper};
}

/// Over the windows as they are, whatever their amount.
double rms_position(std::span<const math::Pose> errors) {
  double sum = 0.0;
  for (const math::Pose& e : errors) sum += square_of(Part::position, e);
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

double mean_amount(std::span<const EvaluationWindow> windows) {
  double sum = 0.0;
  for (const EvaluationWindow& one : windows) sum += one.amount;
  return sum / static_cast<double>(windows.size());
}

double noise_floor(Part part, std::span<const EvaluationWindow> windows) {
  math::RatioOfSums sums;
  for (const EvaluationWindow& s : windows)
    sums += {std::max(variance_of(part, s.covariance), 0.0), s.amount * s.amount};
  return sums.root();
}

/// Windows of one sort, and the errors of each model in them; none of a model that there is not.
struct Judged {
  std::vector<EvaluationWindow> windows;
  std::vector<math::Pose> before, geometry, after;

  [[nodiscard]] bool is_enough() const { return windows.size() >= settings::kFewestOfAKind; }
};

class Judge {
 public:
  Judge(std::span<const measurement::FitData> data, const wheels::BaseParameters& nominal,
        const JudgedModel* geometry, const JudgedModel& full)
      : data_(data),
        full_(full),
        folds_(folds_of(data)),
        measured_pairs_(measured_pairs(data, trusted_pairs(*full.fit))) {
    full_parameters_ = by_fold(full);
    if (nominal.left_radius > 0.0 && nominal.right_radius > 0.0 && nominal.track_width > 0.0)
      nominal_parameters_.assign(kFolds, with_wheels(full.fit->parameters, full.effects, nominal));
    if (geometry != nullptr)
      for (const Eigen::VectorXd& p : by_fold(*geometry))
        geometry_parameters_.push_back(
            with_wheels(full.fit->parameters, full.effects, vehicle::to_base(vehicle::as_span(p))));
  }

  [[nodiscard]] std::vector<EvaluationWindow> windows(WindowKind kind) const {
    return find_windows(kind, data_, folds_, *full_.fit, measured_pairs_);
  }
  [[nodiscard]] std::vector<EvaluationWindow> windows_of_way(double way) const {
    return find_windows_of_way(way, data_, folds_, *full_.fit, measured_pairs_);
  }

  /// Each model goes along each recording once, for the windows of all sorts.
  [[nodiscard]] std::vector<Judged> judged(const std::vector<std::vector<EvaluationWindow>>& sorts) const {
    std::vector<EvaluationWindow> all;
    for (const auto& windows : sorts) all.insert(all.end(), windows.begin(), windows.end());
    const auto measured = measured_motions(data_, all, full_parameters_, full_.effects);
    const auto before = errors(all, measured, nominal_parameters_);
    const auto geometry = errors(all, measured, geometry_parameters_);
    const auto after = errors(all, measured, full_parameters_);
    std::vector<Judged> judged;
    std::ptrdiff_t begin = 0;
    for (const auto& windows : sorts) {
      const std::ptrdiff_t end = begin + std::ssize(windows);
      const auto part = [&](const std::vector<math::Pose>& errors) {
        return errors.empty() ? errors : std::vector(errors.begin() + begin, errors.begin() + end);
      };
      judged.push_back({windows, part(before), part(geometry), part(after)});
      begin = end;
    }
    return judged;
  }

 private:
  /// Empty without parameters.
  [[nodiscard]] std::vector<math::Pose> errors(const std::vector<EvaluationWindow>& windows,
                                               const std::vector<math::Pose>& measured,
                                               const std::vector<Eigen::VectorXd>& parameters) const {
    if (parameters.empty()) return {};
    return errors_of(data_, windows, measured, parameters, full_.effects);
  }

  [[nodiscard]] std::vector<Eigen::VectorXd> by_fold(const JudgedModel& model) const {
    std::vector<Eigen::VectorXd> parameters;
    for (std::size_t fold = 0; fold < kFolds; ++fold)
      parameters.push_back(without_fold(*model.fit, folds_, fold, model.fixed));
    return parameters;
  }

  std::span<const measurement::FitData> data_;
  const JudgedModel& full_;
  std::vector<std::size_t> folds_;
  std::vector<bool> measured_pairs_;  ///< one flag per pair
  std::vector<Eigen::VectorXd> nominal_parameters_, geometry_parameters_, full_parameters_;  ///< by fold
};

/// A figure of the drive, and the windows that it is judged over.
struct Figure {
  std::size_t kind = 0;  ///< in kKinds
  const char* name;
  Part part;
};

constexpr std::array kKinds = {WindowKind::straight, WindowKind::turn, WindowKind::open_loop};
constexpr std::array kFigures = {
    Figure{0, "straight_metre_length", Part::along}, Figure{0, "straight_metre_heading", Part::heading},
    Figure{1, "full_turn_heading", Part::heading}, Figure{2, kOpenLoopPosition, Part::position},
    Figure{2, "open_loop_10s_heading", Part::heading}};

DriveError drive_error(const Figure& figure, const Judged& judged) {
  const auto error_with = [&](std::span<const math::Pose> errors) {
    return errors.empty() ? std::nullopt : std::optional(bounded(figure.part, judged.windows, errors));
  };
  return {figure.name,
          figure.part == Part::heading ? "rad" : "m",
          judged.windows.size(),
          error_with(judged.before),
          error_with(judged.geometry),
          error_with(judged.after),
          noise_floor(figure.part, judged.windows)};
}

ErrorGrowth growth_over(const Judged& judged) {
  const auto error_with = [](std::span<const math::Pose> errors) {
    return errors.empty() ? std::nullopt : std::optional(rms_position(errors));
  };
  return {mean_amount(judged.windows), judged.windows.size(), error_with(judged.before),
          error_with(judged.geometry), error_with(judged.after)};
}

}  // namespace

Eigen::VectorXd with_wheels(const Eigen::VectorXd& full, const vehicle::EffectList& effects,
                            const wheels::BaseParameters& base) {
  Eigen::VectorXd parameters = full;
  parameters(vehicle::kLeftRadius) = base.left_radius;
  parameters(vehicle::kRightRadius) = base.right_radius;
  parameters(vehicle::kTrackWidth) = base.track_width;
  Eigen::Index index = vehicle::kBaseCount;
  for (const auto& effect : effects) {
    const bool kept = terms::concerns_reference(*effect);
    for (const vehicle::EffectParameter& parameter : effect->parameters()) {
      if (!kept) parameters(index) = parameter.start;
      ++index;
    }
  }
  return parameters;
}

std::vector<DriveError> drive_errors(std::span<const measurement::FitData> data,
                                     const wheels::BaseParameters& nominal, const JudgedModel* geometry,
                                     const JudgedModel& full) {
  const Judge judge(data, nominal, geometry, full);
  std::vector<std::vector<EvaluationWindow>> windows(kKinds.size());
  std::transform(kKinds.begin(), kKinds.end(), windows.begin(),
                 [&](WindowKind kind) { return judge.windows(kind); });
  const std::vector<Judged> judged = judge.judged(windows);
  std::vector<DriveError> errors;
  for (const Figure& figure : kFigures)
    if (judged[figure.kind].is_enough()) errors.push_back(drive_error(figure, judged[figure.kind]));
  return errors;
}

std::vector<ErrorGrowth> error_growth(std::span<const measurement::FitData> data,
                                      const wheels::BaseParameters& nominal, const JudgedModel* geometry,
                                      const JudgedModel& full) {
  const Judge judge(data, nominal, geometry, full);
  std::vector<std::vector<EvaluationWindow>> windows(settings::kWays_m.size());
  std::transform(settings::kWays_m.begin(), settings::kWays_m.end(), windows.begin(),
                 [&](double way) { return judge.windows_of_way(way); });
  std::vector<ErrorGrowth> growth;
  for (const Judged& judged : judge.judged(windows))
    if (judged.is_enough()) growth.push_back(growth_over(judged));
  return growth;
}

const DriveError* open_loop_position(const std::vector<DriveError>& errors) {
  const auto found = std::find_if(errors.begin(), errors.end(),
                                  [](const DriveError& error) { return error.name == kOpenLoopPosition; });
  return found == errors.end() ? nullptr : &*found;
}

}  // namespace odomcalib::calib::validation
