// odomcalib-blind: runs a part of a blind campaign, one line of JSON a recording; or makes the table of many
// such lines.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "tests/blind/blind_table.hpp"
#include "tests/blind/blind_trial.hpp"
#include "tests/sim/effects/effect.hpp"

namespace {

using odomcalib::blind::Trial;

int run(std::uint64_t campaign, unsigned first, unsigned count, const odomcalib::sim::BlindOptions& options) {
  for (unsigned number = first; number < first + count; ++number) {
    const Trial trial = odomcalib::blind::run_trial(campaign, number, options);
    std::puts(odomcalib::blind::to_json_line(trial).c_str());
    std::fflush(stdout);
  }
  return 0;
}

int print_table(const std::vector<std::string>& files) {
  std::vector<Trial> trials;
  for (const std::string& name : files) {
    std::ifstream file(name);
    for (std::string line; std::getline(file, line);)
      trials.push_back(odomcalib::blind::trial_from_json_line(line));
  }
  std::fputs(odomcalib::blind::table(trials).c_str(), stdout);
  return trials.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Blind test: recordings with effects that the solver is not told about, scored"};
  std::uint64_t campaign = 1;
  unsigned first = 0, count = 10;
  odomcalib::sim::BlindOptions options;
  std::vector<std::string> files;
  app.add_option("--seed", campaign, "of the campaign");
  app.add_option("--first", first, "number of the first recording");
  app.add_option("--count", count, "number of recordings");
  app.add_option("--without", options.share_without_effect, "share of recordings without effect");
  app.add_option("--effects", options.effects, "effects in one recording");
  app.add_flag("--catalogue", options.only_catalogue, "only effects that the catalogue has");
  app.add_flag("--any-machine", options.any_machine,
               "other lidars, encoders and sizes than the usual robot's");
  app.add_flag("--tour", options.tour, "drives at work, forward only, instead of drives for calibration");
  app.add_flag("--free-laws", options.free_laws,
               "anything the robot does changes anything it moves by, by no mechanism");
  std::set<std::string> names;
  for (const auto& kind : odomcalib::sim::effect_kinds()) names.insert(kind.name);
  app.add_option("--only", options.only, "only these effects, for a closer look")
      ->check(CLI::IsMember(names));
  app.add_option("--table", files, "make the table of these files of lines instead");
  CLI11_PARSE(app, argc, argv);
  return files.empty() ? run(campaign, first, count, options) : print_table(files);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
