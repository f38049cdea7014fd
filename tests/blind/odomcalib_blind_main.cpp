// odomcalib-blind: runs a part of a blind campaign, one line of JSON a recording; or makes the table of many
// such lines.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "calib/selection/rules.hpp"
#include "tests/blind/ablation.hpp"
#include "tests/blind/blind_table.hpp"
#include "tests/blind/blind_trial.hpp"
#include "tests/blind/paired_table.hpp"
#include "tests/sim/effects/blind_cli.hpp"

namespace {

using odomcalib::blind::Trial;

/// Recordings of a campaign.
struct Part {
  std::uint64_t campaign = 1;
  unsigned first = 0, count = 10;
  odomcalib::sim::BlindOptions options;
  bool findings_alone = false;

  [[nodiscard]] odomcalib::blind::Judged judged() const {
    return findings_alone ? odomcalib::blind::Judged::by_its_findings
                          : odomcalib::blind::Judged::by_a_fresh_drive;
  }
};

void put_line(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

/// @param left_out names of rules of the search, or of groups
int run(const Part& part, const std::vector<std::string>& left_out) {
  namespace blind = odomcalib::blind;
  const auto rules = blind::rules_without(left_out);
  for (unsigned number = part.first; number < part.first + part.count; ++number)
    put_line(
        blind::to_json_line(blind::run_trial(part.campaign, number, part.options, part.judged(), rules)));
  return 0;
}

int print_rules() {
  for (const auto& row : odomcalib::calib::selection::rule_table())
    std::printf("%s\t%s\t%s\n", row.name, name_of(row.group), row.protects_against);
  return 0;
}

int print_rule_groups() {
  for (const auto& row : odomcalib::calib::selection::rule_group_table())
    std::printf("%s\t%s\n", row.name, row.protects_against);
  return 0;
}

int run_ablation(const Part& part, odomcalib::blind::AblationOf of) {
  namespace blind = odomcalib::blind;
  for (unsigned number = part.first; number < part.first + part.count; ++number)
    for (const blind::Ablation& one : blind::ablate(part.campaign, number, part.options, part.judged(), of))
      put_line(blind::to_json_line(one));
  return 0;
}

std::vector<Trial> trials_of(const std::vector<std::string>& files) {
  std::vector<Trial> trials;
  for (const std::string& name : files) {
    std::ifstream file(name);
    for (std::string line; std::getline(file, line);)
      trials.push_back(odomcalib::blind::trial_from_json_line(line));
  }
  return trials;
}

int print_table(const std::vector<std::string>& files, const std::vector<std::string>& others,
                bool by_campaign) {
  const std::vector<Trial> trials = trials_of(files);
  const std::string text = !others.empty() ? odomcalib::blind::paired_table(trials, trials_of(others))
                           : by_campaign   ? odomcalib::blind::campaign_table(trials)
                                           : odomcalib::blind::table(trials);
  std::fputs(text.c_str(), stdout);
  return trials.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Blind test: recordings with effects that the solver is not told about, scored"};
  Part part;
  std::vector<std::string> files, others, left_out;
  std::string ablation_of;
  bool rules = false, rule_groups = false, by_campaign = false;
  app.add_option("--seed", part.campaign, "of the campaign");
  app.add_option("--first", part.first, "number of the first recording");
  app.add_option("--count", part.count, "number of recordings");
  odomcalib::sim::add_blind_options(app, part.options);
  app.add_flag("--findings-only", part.findings_alone,
               "judge what is found, and the lengths: no plain fit, no fresh drive");
  app.add_option("--table", files, "make the table of these files of lines instead");
  app.add_option("--beside", others, "pair them with these files, of the same recordings by another version");
  app.add_flag("--by-campaign", by_campaign, "make a table with a line for each campaign");
  // For tests/blind/bed: an empty group keeps them out of the help.
  app.add_option("--without-rule", left_out, "leave out these rules of the search, or these groups")
      ->group("");
  app.add_option("--ablation-of", ablation_of, "leave out each rule, or each group of rules, in turn")
      ->check(CLI::IsMember({"rules", "groups"}))
      ->group("");
  app.add_flag("--rules", rules,
               "list the rules of the search, each with its group and what it protects against")
      ->group("");
  app.add_flag("--rule-groups", rule_groups, "list the groups of rules, each with what it protects against")
      ->group("");
  CLI11_PARSE(app, argc, argv);
  if (rules) return print_rules();
  if (rule_groups) return print_rule_groups();
  if (!files.empty()) return print_table(files, others, by_campaign);
  using odomcalib::blind::AblationOf;
  if (!ablation_of.empty())
    return run_ablation(part, ablation_of == "groups" ? AblationOf::groups : AblationOf::rules);
  return run(part, left_out);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
