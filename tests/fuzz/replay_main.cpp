// Replays a corpus through a fuzz harness without libFuzzer: each file as it is, cut off at many places, and
// with single bytes changed; at few places where an input is a whole session. Fails when the corpus is
// missing or empty, so that a lost corpus cannot pass unnoticed. With --plain only each file as it is: what
// the corpus itself reaches.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

#ifndef ODOMCALIB_FUZZ_CUTS
#define ODOMCALIB_FUZZ_CUTS 64
#endif
#ifndef ODOMCALIB_FUZZ_CHANGES
#define ODOMCALIB_FUZZ_CHANGES 200
#endif

namespace {

void feed(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void feed_variants(const std::string& bytes) {
  constexpr std::size_t kCuts = ODOMCALIB_FUZZ_CUTS;
  constexpr int kChanges = ODOMCALIB_FUZZ_CHANGES;
  feed(bytes);
  for (std::size_t i = 0; i < kCuts; ++i) feed(bytes.substr(0, bytes.size() * i / kCuts));
  std::mt19937 random(static_cast<std::uint32_t>(bytes.size()));  // fixed seed: a failure repeats
  for (int i = 0; i < kChanges && !bytes.empty(); ++i) {
    std::string changed = bytes;
    changed[random() % changed.size()] = static_cast<char>(random());
    feed(changed);
  }
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const bool plain = argc == 3 && std::string(argv[1]) == "--plain";
  if (argc != 2 && !plain) {
    std::fprintf(stderr, "usage: %s [--plain] CORPUS_FOLDER\n", argv[0]);
    return 2;
  }
  if (!plain) feed("");
  const auto files = files_in(argv[argc - 1]);
  for (const auto& path : files) plain ? feed(read(path)) : feed_variants(read(path));
  std::printf("replayed %zu files from %s\n", files.size(), argv[argc - 1]);
  return files.empty() ? 1 : 0;
}
