#include "tests/blind/paired_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <map>
#include <utility>

#include "tests/blind/blind_table.hpp"

namespace odomcalib::blind {
namespace {

constexpr double kSameError = 0.01;  // of the error on the fresh drive

using Pair = std::pair<const Trial*, const Trial*>;

std::vector<Pair> pairs_of(const std::vector<Trial>& one, const std::vector<Trial>& other) {
  std::map<std::pair<std::uint64_t, unsigned>, const Trial*> others;
  for (const Trial& trial : other) others[{trial.answer.campaign, trial.answer.number}] = &trial;
  std::vector<Pair> pairs;
  for (const Trial& trial : one)
    if (const auto found = others.find({trial.answer.campaign, trial.answer.number}); found != others.end())
      pairs.emplace_back(&trial, found->second);
  return pairs;
}

/// A question that a trial may get right.
struct Question {
  const char* text;
  bool (*concerns)(const Trial&);
  bool (*is_right)(const Trial&);
};

template <std::size_t k>
bool length_holds(const Trial& trial) {
  return std::abs(trial.sigmas[k]) <= kSigmas;
}
bool always(const Trial& /*trial*/) { return true; }
bool has_fresh_drive(const Trial& trial) { return trial.judged == Judged::by_a_fresh_drive; }
bool is_not_worse(const Trial& trial) { return !worse_than_plain(trial); }
bool reports_nothing(const Trial& trial) { return !claims_anything(trial); }
bool hurts_by_name(const Trial& trial) { return is_of_the_catalogue(trial) && is_detectable(trial); }
bool hurts_without_name(const Trial& trial) {
  return is_outside_the_catalogue(trial) && is_detectable(trial);
}

constexpr std::array kQuestions = {
    Question{"effect of the catalogue that hurts: named", hurts_by_name, names_every_effect},
    Question{"effect outside the catalogue that hurts: flagged", hurts_without_name, flags_right_variable},
    Question{"no effect: none reported", has_no_effect, reports_nothing},
    Question{"left diameter within 3 stated deviations", always, length_holds<0>},
    Question{"right diameter within 3 stated deviations", always, length_holds<1>},
    Question{"track width within 3 stated deviations", always, length_holds<2>},
    Question{"odometry not worse than by the plain fit", has_fresh_drive, is_not_worse}};

std::string row_of(const Question& question, const std::vector<Pair>& pairs) {
  std::array<std::size_t, 4> count{};  // neither, only the one, only the other, both
  for (const auto& [one, other] : pairs)
    if (question.concerns(*one) || question.concerns(*other))
      ++count[(question.is_right(*one) ? 1U : 0U) + (question.is_right(*other) ? 2U : 0U)];
  return fmt::format("| {} | {} | {} | {} | {} | {:.2f} |\n", question.text, count[3], count[1], count[2],
                     count[0], sign_test(count[1], count[2]));
}

std::string error_row(const std::vector<Pair>& pairs) {
  std::size_t one_smaller = 0, other_smaller = 0;
  std::vector<double> ratios;
  for (const auto& [one, other] : pairs) {
    if (!has_fresh_drive(*one) || !has_fresh_drive(*other)) continue;
    ratios.push_back(other->after.position.rms / std::max(one->after.position.rms, 1e-9));
    if (ratios.back() > 1.0 + kSameError) ++one_smaller;
    if (ratios.back() < 1.0 - kSameError) ++other_smaller;
  }
  std::sort(ratios.begin(), ratios.end());
  return fmt::format(
      "| error on the fresh drive smaller by more than 1 % (median ratio {:.3f}) | {} | {} | {} | | "
      "{:.2f} |\n",
      ratios.empty() ? 1.0 : ratios[ratios.size() / 2], ratios.size() - one_smaller - other_smaller,
      one_smaller, other_smaller, sign_test(one_smaller, other_smaller));
}

}  // namespace

double sign_test(std::size_t one, std::size_t other) {
  const boost::math::binomial fair(static_cast<double>(one + other), 0.5);
  return std::min(1.0, 2.0 * boost::math::cdf(fair, static_cast<double>(std::min(one, other))));
}

std::string paired_table(const std::vector<Trial>& one, const std::vector<Trial>& other) {
  const std::vector<Pair> pairs = pairs_of(one, other);
  std::string text = fmt::format(
      "| {} recordings | both | only the one | only the other | neither | p |\n| --- | --- | --- | --- | --- "
      "| --- "
      "|\n",
      pairs.size());
  for (const Question& question : kQuestions) text += row_of(question, pairs);
  return text + error_row(pairs);
}

}  // namespace odomcalib::blind
