// odomcalib-blind: runs a part of a blind campaign, one line of JSON a recording; or makes the table of many
// such lines.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "tests/blind/blind_table.hpp"
#include "tests/blind/blind_trial.hpp"
#include "tests/sim/effects/blind_cli.hpp"

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
  odomcalib::sim::add_blind_options(app, options);
  app.add_option("--table", files, "make the table of these files of lines instead");
  CLI11_PARSE(app, argc, argv);
  return files.empty() ? run(campaign, first, count, options) : print_table(files);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}
