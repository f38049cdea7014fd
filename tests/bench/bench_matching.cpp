// Branch and bound against brute force on a thousand random cases: the same optimum, from how much of the
// time? Run build/release/bin/bench_matching.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "calib/matching/pose_search.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace {

using namespace odomcalib;
using calib::Pose;

constexpr unsigned kCases = 1000;

std::vector<Eigen::Vector2d> points_of(const Scan& scan, std::size_t stride) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < scan.ranges.size(); i += stride)
    if (scan.ranges[i] > 0.0F)
      points.push_back(static_cast<double>(scan.ranges[i]) *
                       Eigen::Vector2d(std::cos(scan.angle(i)), std::sin(scan.angle(i))));
  return points;
}

template <typename Search>
double timed(const Search& search) {
  timespec begin{}, end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  search();
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  return static_cast<double>(end.tv_sec - begin.tv_sec) +
         1e-9 * static_cast<double>(end.tv_nsec - begin.tv_nsec);
}

/// Whether all optima are equal.
bool compare(double cell) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double brute_time = 0.0;
  double bound_time = 0.0;
  double work = 0.0;
  unsigned equal = 0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    const Pose a{uniform(engine), uniform(engine), calib::kPi * uniform(engine)};
    const Pose motion{uniform(engine), uniform(engine), 0.7 * uniform(engine)};
    const auto reference = points_of(testing::scan_from(testing::kRoom, a, 0.02, seed), 2);
    const auto points =
        points_of(testing::scan_from(testing::kRoom, calib::compose(a, motion), 0.02, seed + kCases), 10);
    calib::LikelihoodField field(reference, {.cell = cell});
    calib::SearchResult brute, bound;
    // The coarser levels are made inside: they are part of the work of one search.
    bound_time += timed([&] { bound = calib::search_branch_and_bound(field, points, {}); });
    brute_time += timed([&] { brute = calib::search_brute_force(field, points, {}); });
    if (bound.score == brute.score) ++equal;
    work += static_cast<double>(bound.evaluated) / static_cast<double>(brute.evaluated);
  }
  std::printf(
      "+-1 m, +-45 degrees, cells of %.2f m: %u of %u optima equal; brute force %.2f ms, branch and bound "
      "%.3f ms, "
      "%.0f times faster; one of %.0f poses scored\n",
      cell, equal, kCases, 1e3 * brute_time / kCases, 1e3 * bound_time / kCases, brute_time / bound_time,
      kCases / work);
  return equal == kCases;
}

}  // namespace

int main() {
  const bool coarse = compare(0.1);
  return compare(0.05) && coarse ? 0 : 1;
}
