// odomcalib-sim-blind: a campaign of recordings with unknown effects, and the sealed answers.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "proto/file_bytes.hpp"
#include "tests/sim/effects/blind_cli.hpp"

namespace {

namespace fs = std::filesystem;

bool write_answers(const fs::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{
      "Draws robots, rooms, drives and effects; writes recordings, and the answers into a file of their own"};
  std::uint64_t seed = 1;
  unsigned first = 0, count = 10;
  fs::path folder;
  odomcalib::sim::BlindOptions options;
  app.add_option("--seed", seed, "of the campaign");
  app.add_option("--first", first, "number of the first recording");
  app.add_option("--count", count, "number of recordings");
  app.add_option("--out", folder, "folder for case-N.jsonl.gz and answers.json")->required();
  odomcalib::sim::add_blind_options(app, options);
  CLI11_PARSE(app, argc, argv);

  std::error_code error;
  fs::create_directories(folder, error);
  std::vector<odomcalib::sim::BlindAnswer> answers;
  for (unsigned number = first; number < first + count; ++number) {
    const auto drawn = odomcalib::sim::make_blind_case(seed, number, options);
    const fs::path file = folder / ("case-" + std::to_string(number) + ".jsonl.gz");
    if (const auto written = odomcalib::write_recording_jsonl(drawn.run.recording, file); !written) {
      std::fprintf(stderr, "odomcalib-sim-blind: %s\n", written.error().text().c_str());
      return 1;
    }
    answers.push_back(drawn.answer);
  }
  const std::string text = answers_json(answers);
  if (!write_answers(folder / "answers.json", text)) {
    std::fprintf(stderr, "odomcalib-sim-blind: cannot write %s\n", (folder / "answers.json").c_str());
    return 1;
  }
  std::printf("%u recordings in %s\nseal of answers.json (SHA-256): %s\n", count, folder.c_str(),
              odomcalib::sha256_hex(text).c_str());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "odomcalib-sim-blind: %s\n", error.what());
  return 1;
}
