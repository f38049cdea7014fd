#include "proto/near_miss.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace odomcalib {
namespace {

/// Letters for each of which one may be wrong in a word that is still recognised. Chosen: "trackwidht" is.
constexpr std::size_t kLettersPerError = 3;
/// Letters. Derived: no key is longer; it bounds the work on hostile files.
constexpr std::size_t kLongestWord = 64;
/// Letters of a word that may stand for a longer one. Chosen: "track" for "track_width", not "l" for "lidar".
constexpr std::size_t kShortestBegin = 4;

std::string last_part(const std::string& path) { return path.substr(path.rfind('.') + 1); }

/// Damerau-Levenshtein distance with adjacent exchanges (optimal string alignment).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> near_miss(const std::string& word, const std::set<std::string>& known) {
  if (word.empty() || word.size() > kLongestWord) return std::nullopt;
  std::optional<std::string> nearest;
  // Errors, and letters that tell apart those that have as many.
  std::pair<std::size_t, std::size_t> least{word.size() / kLettersPerError + 1, 0};
  for (const std::string& candidate : known) {
    const bool elsewhere = last_part(candidate) == last_part(word);
    const bool begins = word.size() >= kShortestBegin && candidate.starts_with(word + "_");
    const std::size_t letters = distance(word, candidate);
    const std::pair rank{elsewhere ? 0 : begins ? 1 : letters, letters};
    if (rank >= least) continue;
    least = rank;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace odomcalib
