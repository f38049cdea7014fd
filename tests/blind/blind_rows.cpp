#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/blind/blind_trial.hpp"

namespace odomcalib::blind {
namespace {

using Json = nlohmann::ordered_json;

template <std::size_t n>
Json rounded_json(const std::array<double, n>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(rounded(value));
  return json;
}

Json error_json(const DriveError& error) {
  return rounded_json(
      std::array{error.position.rms, error.heading.rms, error.position.upper, error.heading.upper});
}
DriveError error_from(const Json& json) { return {{json.at(0), json.at(2)}, {json.at(1), json.at(3)}}; }

Json effect_json(const sim::BlindEffect& effect) {
  return {{"name", effect.name},
          {"catalogue_name", effect.catalogue_name},
          {"depends_on", effect.depends_on},
          {"size", rounded(effect.size)},
          {"unit", effect.unit}};
}

sim::BlindEffect effect_from(const Json& json) {
  return {json.at("name"), json.at("catalogue_name"), json.at("depends_on"), json.at("size"),
          json.at("unit")};
}

}  // namespace

double rounded(double value) { return std::stod(fmt::format("{:.5g}", value)); }

std::string to_json_line(const Trial& trial) {
  Json injected = Json::array();
  for (const sim::BlindEffect& effect : trial.answer.effects) injected.push_back(effect_json(effect));
  Json json{{"campaign", trial.answer.campaign},
            {"number", trial.answer.number},
            {"drive", trial.answer.drive},
            {"injected", injected},
            {"named", trial.named},
            {"aliases", trial.aliases},
            {"depends_on", trial.depends_on},
            {"sigmas", rounded_json(trial.sigmas)}};
  if (trial.judged == Judged::by_a_fresh_drive)
    json.update({{"plain_sigmas", rounded_json(trial.plain_sigmas)},
                 {"residual_over_floor", rounded_json(trial.residual_over_floor)},
                 {"before", error_json(trial.before)},
                 {"after", error_json(trial.after)},
                 {"twin", error_json(trial.twin)}});
  json.update({{"solve_seconds", rounded(trial.solve_seconds)}, {"refused", trial.refused}});
  return json.dump();
}

Trial trial_from_json_line(const std::string& line) {
  const Json json = Json::parse(line);
  Trial trial;
  trial.answer.campaign = json.at("campaign");
  trial.answer.number = json.at("number");
  trial.answer.drive = json.at("drive");
  for (const Json& effect : json.at("injected")) trial.answer.effects.push_back(effect_from(effect));
  trial.named = json.at("named");
  trial.aliases = json.at("aliases");
  trial.depends_on = json.at("depends_on");
  trial.sigmas = json.at("sigmas");
  trial.judged = json.contains("after") ? Judged::by_a_fresh_drive : Judged::by_its_findings;
  if (trial.judged == Judged::by_a_fresh_drive) {
    trial.plain_sigmas = json.at("plain_sigmas");
    trial.residual_over_floor = json.at("residual_over_floor");
    trial.before = error_from(json.at("before"));
    trial.after = error_from(json.at("after"));
    trial.twin = error_from(json.at("twin"));
  }
  trial.solve_seconds = json.at("solve_seconds");
  trial.refused = json.at("refused");
  return trial;
}

}  // namespace odomcalib::blind
