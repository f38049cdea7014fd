#include "tests/blind/blind_table.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

namespace odomcalib::blind {
namespace {

constexpr double kDetectable = 1.3;  // times the noise floor

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

/// Names that the solver may give to a variable of the simulator.
const std::map<std::string, std::set<std::string>>& same_variables() {
  static const std::map<std::string, std::set<std::string>> kSame = {
      {"acceleration", {"left_acceleration", "right_acceleration", "acceleration"}},
      {"speed*yaw_rate", {"lateral_acceleration"}},
      {"yaw_rate", {"turn_rate"}},
      {"yaw_acceleration", {"turn_acceleration"}},
      {"speed", {"speed", "left_speed", "right_speed", "wheel_speed"}},
      {"wheel_phase", {"left_phase", "right_phase"}},
      {"wheel_speed", {"left_speed", "right_speed", "wheel_speed", "speed"}},
      {"reversal", {"since_reversal", "left_since_reversal", "right_since_reversal"}},
      {"distance_since_reversal", {"since_reversal", "left_since_reversal", "right_since_reversal"}},
      {"direction", {"speed", "left_speed", "right_speed", "wheel_speed"}},
      {"heading", {"heading"}},
      {"position", {"position"}},
      {"time", {"time"}},
      {"previous_turn", {"previous_turn"}},
      {"distance_since_stop", {"since_stop"}},
      {"history", {"previous_turn", "previous_push", "since_reversal", "since_stop"}},
      {"bearing", {"bearing"}},
      {"incidence", {"incidence"}}};
  return kSame;
}

/// Variables that an effect of the catalogue depends on, in the solver's words.
const std::map<std::string, std::set<std::string>>& variables_of_names() {
  static const std::map<std::string, std::set<std::string>> kOf = {
      {"acceleration_slip", {"left_acceleration", "right_acceleration"}},
      {"backlash", {"left_since_reversal", "right_since_reversal"}},
      {"carpet", {"heading"}},
      {"caster_kick", {"since_reversal"}},
      {"direction_dependent_diameter", {"left_speed", "right_speed", "wheel_speed"}},
      {"drift_with_time", {"time"}},
      {"encoder_lag", {"left_acceleration", "right_acceleration"}},
      {"floor_slope", {"heading"}},
      {"lateral_slip", {"lateral_acceleration"}},
      {"speed_dependent_radius", {"left_speed", "right_speed", "wheel_speed"}},
      {"speed_dependent_track", {"turn_rate"}},
      {"stop_settling", {"since_stop"}},
      {"tick_loss", {"left_speed", "right_speed", "wheel_speed"}},
      {"track_depends_on_motion", {"speed", "turn_rate"}},
      {"turn_direction_asymmetry", {"turn_rate"}},
      {"wheel_eccentricity", {"left_phase", "right_phase"}}};
  return kOf;
}

bool mentions(const Trial& trial, const std::string& variable) {
  const auto same = same_variables().find(variable);
  if (same == same_variables().end()) return false;
  for (const std::string& word : same->second) {
    if (contains(trial.depends_on, word)) return true;
    for (const std::string& name : trial.named) {
      const auto of = variables_of_names().find(name);
      if (of != variables_of_names().end() && of->second.count(word) > 0) return true;
    }
  }
  return false;
}

std::string percent(std::size_t part, std::size_t whole) {
  char text[64];
  std::snprintf(text, sizeof text, "%zu of %zu (%.1f %%)", part, whole,
                whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

/// With the exact 95 % interval of the share (Clopper and Pearson, Biometrika 26, 1934).
std::string percent_with_interval(std::size_t part, std::size_t whole) {
  if (whole == 0) return percent(part, whole);
  constexpr double kOneSide = 0.025;
  using Binomial = boost::math::binomial;
  const auto trials = static_cast<double>(whole), successes = static_cast<double>(part);
  char text[64];
  std::snprintf(text, sizeof text, ", 95 %%: %.2f to %.2f %%",
                100.0 * Binomial::find_lower_bound_on_p(trials, successes, kOneSide),
                100.0 * Binomial::find_upper_bound_on_p(trials, successes, kOneSide));
  return percent(part, whole) + text;
}

/// A value that nothing gives is a dash.
std::string number(const char* format, double value) {
  if (std::isnan(value)) return "–";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

/// Position error after against that of the robot without the effect.
double ratio_after(const Trial& trial) {
  return trial.after.position.rms / std::max(trial.twin.position.rms, 1e-9);
}
double ratio_before(const Trial& trial) {
  return trial.before.position.rms / std::max(trial.twin.position.rms, 1e-9);
}

using Predicate = bool (*)(const Trial&);

std::vector<const Trial*> select(const std::vector<Trial>& trials, const std::vector<Predicate>& all) {
  std::vector<const Trial*> out;
  for (const Trial& trial : trials)
    if (std::all_of(all.begin(), all.end(), [&](Predicate p) { return p(trial); })) out.push_back(&trial);
  return out;
}

std::size_t count(const std::vector<const Trial*>& trials, Predicate predicate) {
  return static_cast<std::size_t>(
      std::count_if(trials.begin(), trials.end(), [&](const Trial* t) { return predicate(*t); }));
}

bool has_effect(const Trial& t) { return !t.answer.effects.empty(); }
bool is_of_the_robot(const Trial& t) { return !belongs_to_the_place(t); }
bool has_fresh_drive(const Trial& t) { return t.judged == Judged::by_a_fresh_drive; }
bool worse_by_a_tenth(const Trial& t) { return t.after.position.rms > 1.1 * t.before.position.rms; }

std::string line(const std::string& what, const std::string& result) {
  return "| " + what + " | " + result + " |\n";
}

std::string ratios_line(const std::string& what, const std::vector<const Trial*>& trials,
                        double (*ratio)(const Trial&)) {
  std::vector<double> values;
  values.reserve(trials.size());
  for (const Trial* t : trials) values.push_back(ratio(*t));
  return line(what, number("median %.2f", quantile(values, 0.5)) +
                        number(", 90 %% below %.2f", quantile(values, 0.9)));
}

std::string sigma_line(const std::vector<Trial>& trials, const std::string& what, bool plain) {
  std::size_t within = 0, all = 0;
  for (const Trial& t : trials)
    if (has_fresh_drive(t) || !plain)
      for (const double s : plain ? t.plain_sigmas : t.sigmas) {
        ++all;
        if (std::abs(s) <= kSigmas) ++within;
      }
  return line(what, percent(within, all));
}

std::string summary(const std::vector<Trial>& trials) {
  const auto none = select(trials, {has_no_effect});
  const auto named = select(trials, {is_of_the_catalogue, is_detectable});
  const auto foreign = select(trials, {is_outside_the_catalogue, is_detectable});
  const auto of_robot = select(trials, {has_effect, is_detectable, is_of_the_robot});
  const auto driven = select(trials, {has_fresh_drive});
  std::vector<double> seconds;
  seconds.reserve(trials.size());
  for (const Trial& t : trials) seconds.push_back(t.solve_seconds);
  return "| | |\n| --- | --- |\n" + line("recordings", std::to_string(trials.size())) +
         line("catalogue effects that hurt: named, or in the named set",
              percent(count(named, names_every_effect), named.size())) +
         line("robots without an effect that got one",
              percent_with_interval(count(none, claims_anything), none.size())) +
         line("effects outside the catalogue that hurt: flagged with the right variable",
              percent(count(foreign, flags_right_variable), foreign.size())) +
         line("position error on the fresh drive over a tenth above the plain fit's",
              percent(count(driven, worse_by_a_tenth), driven.size())) +
         line("position or heading error above the 95 % interval of the plain fit's",
              percent(count(driven, worse_than_plain), driven.size())) +
         ratios_line("error over 10 s against the robot without the effect, plain fit", of_robot,
                     ratio_before) +
         ratios_line("the same, after", of_robot, ratio_after) +
         sigma_line(trials, "diameters and track within 3 stated deviations of the truth", false) +
         sigma_line(trials, "the same, plain fit", true) +
         line("CPU time of a solve", number("median %.1f s", quantile(seconds, 0.5)) +
                                         number(", longest %.1f s", quantile(seconds, 1.0)));
}

std::string key(const Trial& trial) {
  std::string text;
  for (const sim::BlindEffect& e : trial.answer.effects) text += (text.empty() ? "" : " + ") + e.name;
  return text.empty() ? "(none)" : text;
}

std::string found_text(const Trial& trial) {
  std::string text;
  for (const std::string& name : trial.named) text += (text.empty() ? "" : ", ") + name;
  for (const std::string& name : trial.depends_on) text += (text.empty() ? "f(" : ", f(") + name + ")";
  return text.empty() ? "nothing" : text;
}

std::string per_kind(const std::vector<Trial>& trials) {
  struct Row {
    std::size_t runs = 0, hurting = 0, right = 0;
    std::vector<double> before, after;
    std::map<std::string, int> found;
  };
  std::map<std::string, Row> rows;
  for (const Trial& t : trials) {
    Row& row = rows[key(t)];
    ++row.runs;
    if (is_detectable(t)) {
      ++row.hurting;
      if (is_outside_the_catalogue(t) ? flags_right_variable(t) : names_every_effect(t)) ++row.right;
    }
    if (has_fresh_drive(t)) row.before.push_back(ratio_before(t));
    if (has_fresh_drive(t)) row.after.push_back(ratio_after(t));
    ++row.found[found_text(t)];
  }
  std::string text =
      "| effect | runs | hurt | of these right | error before | after | found |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& [name, row] : rows) {
    std::string found;
    for (const auto& [what, times] : row.found) {
      found.append(found.empty() ? "" : "; ").append(what);
      if (times > 1) found.append(" x").append(std::to_string(times));
    }
    const std::vector<std::string> cells = {name,
                                            std::to_string(row.runs),
                                            std::to_string(row.hurting),
                                            std::to_string(row.right),
                                            number("%.2f", quantile(row.before, 0.5)),
                                            number("%.2f", quantile(row.after, 0.5)),
                                            found};
    for (const std::string& cell : cells) text.append("| ").append(cell).append(" ");
    text += "|\n";
  }
  return text;
}

/// One line of the table by campaigns.
std::string campaign_line(const std::string& name, const std::vector<Trial>& trials) {
  const auto none = select(trials, {has_no_effect});
  const auto named = select(trials, {is_of_the_catalogue, is_detectable});
  const auto foreign = select(trials, {is_outside_the_catalogue, is_detectable});
  const auto driven = select(trials, {has_fresh_drive});
  const auto of = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? "–" : std::to_string(part) + " of " + std::to_string(whole);
  };
  std::size_t lengths = 0;
  for (const Trial& t : trials)
    lengths += static_cast<std::size_t>(std::count_if(
        t.sigmas.begin(), t.sigmas.end(), [](double sigma) { return std::abs(sigma) <= kSigmas; }));
  std::vector<double> errors;
  for (const Trial* t : select(trials, {has_effect, is_detectable, is_of_the_robot}))
    errors.push_back(ratio_after(*t));
  const std::vector<std::string> cells = {
      name,
      std::to_string(trials.size()),
      of(count(named, names_every_effect), named.size()),
      of(count(foreign, flags_right_variable), foreign.size()),
      none.empty() ? "–" : percent_with_interval(count(none, claims_anything), none.size()),
      of(lengths, 3 * trials.size()),
      of(count(driven, worse_than_plain), driven.size()),
      number("%.2f", quantile(errors, 0.5)) + ", " + number("%.2f", quantile(errors, 0.9))};
  std::string text;
  for (const std::string& cell : cells) text.append("| ").append(cell).append(" ");
  return text + "|\n";
}

}  // namespace

bool has_no_effect(const Trial& trial) { return trial.answer.effects.empty(); }

bool is_of_the_catalogue(const Trial& trial) { return has_effect(trial) && !is_outside_the_catalogue(trial); }

bool is_outside_the_catalogue(const Trial& trial) {
  return std::any_of(trial.answer.effects.begin(), trial.answer.effects.end(),
                     [](const sim::BlindEffect& e) { return e.catalogue_name.empty(); });
}

bool claims_anything(const Trial& trial) { return !trial.named.empty() || !trial.depends_on.empty(); }

bool worse_than_plain(const Trial& trial) {
  return trial.after.position.rms > trial.before.position.upper ||
         trial.after.heading.rms > trial.before.heading.upper;
}

bool is_detectable(const Trial& trial) {
  if (trial.answer.effects.empty()) return false;
  return ratio_before(trial) >= kDetectable ||
         *std::max_element(trial.residual_over_floor.begin(), trial.residual_over_floor.end()) >= kDetectable;
}

bool names_every_effect(const Trial& trial) {
  return std::all_of(
      trial.answer.effects.begin(), trial.answer.effects.end(), [&](const sim::BlindEffect& e) {
        return contains(trial.named, e.catalogue_name) || contains(trial.aliases, e.catalogue_name);
      });
}

bool flags_right_variable(const Trial& trial) {
  return std::all_of(
      trial.answer.effects.begin(), trial.answer.effects.end(), [&](const sim::BlindEffect& e) {
        return std::any_of(e.depends_on.begin(), e.depends_on.end(),
                           [&](const std::string& variable) { return mentions(trial, variable); });
      });
}

bool belongs_to_the_place(const Trial& trial) {
  static const std::set<std::string> kPlace = {"heading", "position", "time"};
  return std::any_of(trial.answer.effects.begin(), trial.answer.effects.end(), [](const auto& effect) {
    return std::any_of(effect.depends_on.begin(), effect.depends_on.end(),
                       [](const std::string& v) { return kPlace.count(v) > 0; });
  });
}

std::string campaign_table(const std::vector<Trial>& trials) {
  std::map<std::uint64_t, std::vector<Trial>> campaigns;
  for (const Trial& t : trials) campaigns[t.answer.campaign].push_back(t);
  std::string text =
      "| campaign | recordings | named | flagged | false findings | lengths within 3 | worse | error: "
      "median, "
      "90 % below |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& [campaign, own] : campaigns) text += campaign_line(std::to_string(campaign), own);
  return text + campaign_line("all", trials);
}

std::string table(const std::vector<Trial>& trials) { return summary(trials) + "\n" + per_kind(trials); }

}  // namespace odomcalib::blind
