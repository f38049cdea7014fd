// Accuracy of the calibration beside the bound that the range readings give: four-minute drives of simulated
// robots. Run build/release/bin/bench_accuracy [RUNS [FIRST_SEED [EFFECTS]]]; exit status 1 when a bar is
// missed.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/integration/accuracy_runs.hpp"

int main(int argc, char** argv) {
  using namespace odomcalib::test_support;
  const unsigned long runs = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 50;
  const unsigned long first = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
  const std::string effects = argc > 3 ? argv[3] : "auto";
  AccuracyTable table;
  for (unsigned long seed = first; seed < first + runs; ++seed) {
    if (const std::string reason = table.add(four_minutes(seed), effects); !reason.empty())
      std::printf("seed %lu: %s\n", seed, reason.c_str());
    std::fflush(stdout);
  }
  table.print();
  return table.worst_ratio() <= kRatioBar && table.is_honest() ? 0 : 1;
}
