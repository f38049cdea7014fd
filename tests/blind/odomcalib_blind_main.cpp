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
};

void put_line(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

/// @param without_rule name of a rule of the search; empty: all hold
int run(const Part& part, const std::string& without_rule) {
  namespace blind = odomcalib::blind;
  const auto rules = blind::rules_without(without_rule);
  for (unsigned number = part.first; number < part.first + part.count; ++number)
    put_line(blind::to_json_line(blind::run_trial(part.campaign, number, part.options, rules)));
  return 0;
}

int print_rules() {
  for (const auto& row : odomcalib::calib::selection::rule_table())
    std::printf("%s\t%s\n", row.name, row.protects_against);
  return 0;
}

int run_ablation(const Part& part) {
  namespace blind = odomcalib::blind;
  for (unsigned number = part.first; number < part.first + part.count; ++number)
    for (const blind::Ablation& one : blind::ablate(part.campaign, number, part.options))
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

int print_table(const std::vector<std::string>& files, const std::vector<std::string>& others) {
  const std::vector<Trial> trials = trials_of(files);
  std::fputs((others.empty() ? odomcalib::blind::table(trials)
                             : odomcalib::blind::paired_table(trials, trials_of(others)))
                 .c_str(),
             stdout);
  return trials.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Blind test: recordings with effects that the solver is not told about, scored"};
  Part part;
  std::vector<std::string> files, others;
  std::string without_rule;
  bool ablation = false, rules = false;
  app.add_option("--seed", part.campaign, "of the campaign");
  app.add_option("--first", part.first, "number of the first recording");
  app.add_option("--count", part.count, "number of recordings");
  odomcalib::sim::add_blind_options(app, part.options);
  app.add_option("--table", files, "make the table of these files of lines instead");
  app.add_option("--beside", others, "pair them with these files, of the same recordings by another version");
  // For tests/blind/ablate: an empty group keeps them out of the help.
  app.add_option("--without-rule", without_rule, "leave out this rule of the search")->group("");
  app.add_flag("--ablation", ablation, "leave out each rule of the search in turn")->group("");
  app.add_flag("--rules", rules, "list the rules of the search, each with what it protects against")
      ->group("");
  CLI11_PARSE(app, argc, argv);
  if (rules) return print_rules();
  if (!files.empty()) return print_table(files, others);
  return ablation ? run_ablation(part) : run(part, without_rule);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
