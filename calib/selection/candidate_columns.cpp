#include "calib/selection/candidate_columns.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "calib/estimation/stack.hpp"
#include "calib/terms/effects/step_effect.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/sensitivity.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr std::size_t kChannels = static_cast<std::size_t>(vehicle::kLastChannel) + 1;
static_assert(kChannels <= vehicle::kJetSize);

/// A constant defect on every channel, of size zero: what smooth terms are linear in.
class Defects final : public terms::StepEffect<Defects> {
 public:
  Defects() : StepEffect({.name = "defects", .parameters = one_of_each_channel()}) {}

  template <typename T>
  static void act(const vehicle::StepContext& c, std::span<const T> p, vehicle::WheelStep<T>& step) {
    for (std::size_t k = 0; k < kChannels; ++k) carry(static_cast<vehicle::Channel>(k), c, p[k], step);
  }

 private:
  static std::vector<vehicle::EffectParameter> one_of_each_channel() {
    std::vector<vehicle::EffectParameter> list;
    for (std::size_t k = 0; k < kChannels; ++k)
      list.push_back({to_string(static_cast<vehicle::Channel>(k)), "1", 1.0, -1.0, 1.0});
    return list;
  }
};

/// One recording at the fit along which all candidates are tried.
class Tried {
 public:
  Tried(const measurement::FitData& data, const vehicle::EffectList& effects,
        const estimation::FitResult& fit, measurement::Whitener whitener)
      : model_(*data.model),
        trajectory_(model_.trajectory(vehicle::as_span(fit.parameters), effects)),
        sensitivity_(std::in_place, model_, trajectory_, estimation::intervals_of(data.pairs)),
        whitener_(std::move(whitener)) {}

  /// Before smooth terms are tried, and after effects: what each channel of each tick interval changes, which
  /// is all that smooth terms need.
  void prepare_smooth_terms() {
    model_.forget_on_demand();  // no smooth term asks for them, and responses take as much memory
    responses_ = sensitivity_->by_steps({std::make_shared<Defects>()}, std::vector<double>(kChannels, 0.0));
    sensitivity_.reset();
  }

  /// Functions stay for the next smooth term, which often differs in its channel only.
  [[nodiscard]] Eigen::MatrixXd by_smooth(const terms::SmoothTerm& smooth) {
    const std::span<const vehicle::Channel> channels = acts_on(smooth);
    Eigen::MatrixXd sum = by_part(smooth, channels.front(), 0);
    for (std::size_t part = 1; part < channels.size(); ++part) sum += by_part(smooth, channels[part], part);
    return whitened(std::move(sum));
  }

  [[nodiscard]] Eigen::MatrixXd by_effects(const vehicle::EffectList& effects) const {
    return whitened(sensitivity_->by_more(effects, vehicle::start_of(effects)));
  }

 private:
  [[nodiscard]] Eigen::MatrixXd by_part(const terms::SmoothTerm& smooth, vehicle::Channel channel,
                                        std::size_t part) {
    if (!seen_ || !differ_in_channel_only(*seen_, smooth)) take_functions(smooth, part);
    Eigen::RowVectorXd mean;
    if (has_functions_of_covariate(smooth))
      mean = Eigen::Map<const Eigen::RowVectorXd>(smooth.mean.data(), std::ssize(smooth.mean));
    return responses_[static_cast<std::size_t>(channel)].by_coefficients(functions_, mean);
  }

  /// Those of a covariate without their mean, which hangs on the channel.
  void take_functions(const terms::SmoothTerm& smooth, std::size_t part) {
    seen_ = smooth;
    if (has_functions_of_covariate(smooth)) seen_->mean.clear();
    const auto steps = static_cast<Eigen::Index>(model_.context().size());
    functions_.resize(steps, static_cast<Eigen::Index>(function_count(smooth)));
    const auto& context = model_.context();
    for (Eigen::Index k = 0; k < steps; ++k) {
      constexpr Eigen::Index kAhead = 16;
      __builtin_prefetch(&context[static_cast<std::size_t>(std::min(k + kAhead, steps - 1))]);
      const terms::BasisValues values = functions_in(*seen_, context[static_cast<std::size_t>(k)], part);
      for (Eigen::Index j = 0; j < functions_.cols(); ++j)
        functions_(k, j) = values[static_cast<std::size_t>(j)];
    }
  }

  [[nodiscard]] Eigen::MatrixXd whitened(Eigen::MatrixXd rows) const {
    whitener_.apply(rows);
    return rows;
  }

  const vehicle::DriveModel& model_;
  vehicle::Trajectory trajectory_;
  std::optional<vehicle::Sensitivity> sensitivity_;  ///< until smooth terms are prepared
  std::vector<vehicle::StepResponse> responses_;     ///< one per channel
  measurement::Whitener whitener_;
  std::optional<terms::SmoothTerm> seen_;  ///< whose functions these are, without a mean
  Eigen::MatrixXd functions_;              ///< tick intervals x functions
};

using AllTried = std::vector<std::unique_ptr<Tried>>;

AllTried try_along(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                   const estimation::FitResult& fit) {
  const estimation::Stack stack = estimation::make_stack(data, effects, fit.parameters, false);
  AllTried all;
  for (std::size_t d = 0; d < data.size(); ++d)
    all.push_back(std::make_unique<Tried>(data[d], effects, fit,
                                          whitener_of(data, stack, fit.noise[d], fit.weights, d)));
  return all;
}

/// Rows of all recordings below each other.
Eigen::MatrixXd stacked(const AllTried& recordings, const std::function<Eigen::MatrixXd(Tried&)>& make) {
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index rows = 0;
  for (const auto& recording : recordings) {
    parts.push_back(make(*recording));
    rows += parts.back().rows();
  }
  Eigen::MatrixXd all(rows, parts.empty() ? 0 : parts.front().cols());
  Eigen::Index first = 0;
  for (const Eigen::MatrixXd& part : parts) {
    all.middleRows(first, part.rows()) = part;
    first += part.rows();
  }
  return all;
}

/// As many names among the candidates from `first` on as one sweep of automatic derivatives carries, and one
/// at least; smooth terms are passed over.
std::vector<std::size_t> sweep_from(const std::vector<Candidate>& candidates, std::size_t first) {
  std::vector<std::size_t> sweep;
  std::size_t parameters = 0;
  for (std::size_t k = first; k < candidates.size(); ++k) {
    if (candidates[k].smooth) continue;
    parameters += candidates[k].effect->parameters().size();
    if (parameters > vehicle::kJetSize && !sweep.empty()) break;
    sweep.push_back(k);
  }
  return sweep;
}

void visit_names(const AllTried& recordings, const std::vector<Candidate>& candidates,
                 const CandidateVisit& visit) {
  for (auto sweep = sweep_from(candidates, 0); !sweep.empty();
       sweep = sweep_from(candidates, sweep.back() + 1)) {
    vehicle::EffectList effects;
    for (const std::size_t k : sweep) effects.push_back(candidates[k].effect);
    const Eigen::MatrixXd all = stacked(recordings, [&](Tried& t) { return t.by_effects(effects); });
    Eigen::Index first = 0;
    for (const std::size_t k : sweep) {
      const auto size = static_cast<Eigen::Index>(candidates[k].effect->parameters().size());
      visit(k, all.middleCols(first, size));
      first += size;
    }
  }
}

}  // namespace

void for_each_candidate(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                        const estimation::FitResult& fit, const std::vector<Candidate>& candidates,
                        const CandidateVisit& visit) {
  const AllTried recordings = try_along(data, effects, fit);
  visit_names(recordings, candidates, visit);
  if (std::none_of(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.smooth; })) return;
  for (const auto& recording : recordings) recording->prepare_smooth_terms();
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (const auto& smooth = candidates[k].smooth)
      visit(k, stacked(recordings, [&](Tried& t) { return t.by_smooth(*smooth); }));
}

std::vector<Eigen::MatrixXd> candidate_columns(std::span<const measurement::FitData> data,
                                               const vehicle::EffectList& effects,
                                               const estimation::FitResult& fit,
                                               const std::vector<Candidate>& candidates) {
  std::vector<Eigen::MatrixXd> columns(candidates.size());
  for_each_candidate(data, effects, fit, candidates,
                     [&](std::size_t k, Eigen::MatrixXd one) { columns[k] = std::move(one); });
  return columns;
}

}  // namespace odomcalib::calib::selection
