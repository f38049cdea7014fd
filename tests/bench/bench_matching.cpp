// Branch and bound against brute force on a thousand random cases: the same optimum, from how much of the
// time? And what a hill climb gives away for its speed, over its parameters. And nearest neighbours in a scan
// by the order of its bearings beside nanoflann's kd-tree. Run build/release/bin/bench_matching.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "calib/matching/nearest.hpp"
#include "calib/matching/pose_search.hpp"
#include "tests/unit/calib/room_scans.hpp"

namespace {

using namespace odomcalib;
using calib::math::Pose;

constexpr unsigned kCases = 1000;
constexpr double kDegrees = 180.0 / calib::math::kPi;

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

/// A pair of scans in a room and the way between them, each coordinate of either sign.
struct Case {
  Pose motion;
  calib::matching::LikelihoodField field;
  std::vector<Eigen::Vector2d> points;
};

Case random_case(std::mt19937& engine, unsigned seed, const Pose& farthest, double cell) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Pose a{uniform(engine), uniform(engine), calib::math::kPi * uniform(engine)};
  const Pose motion{farthest.x * uniform(engine), farthest.y * uniform(engine),
                    farthest.yaw * uniform(engine)};
  const auto reference = points_of(test_support::scan_from(test_support::kRoom, a, 0.02, seed), 2);
  auto points = points_of(
      test_support::scan_from(test_support::kRoom, calib::math::compose(a, motion), 0.02, seed + kCases), 10);
  return {motion, calib::matching::LikelihoodField(reference, {.cell = cell}), std::move(points)};
}

/// Whether all optima are equal.
bool compare(double cell) {
  std::mt19937 engine(1);
  double brute_time = 0.0;
  double bound_time = 0.0;
  double work = 0.0;
  unsigned equal = 0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    Case c = random_case(engine, seed, {1.0, 1.0, 0.7}, cell);
    calib::matching::SearchResult brute, bound;
    // The coarser levels are made inside: they are part of the work of one search.
    bound_time += timed([&] { bound = calib::matching::search_branch_and_bound(c.field, c.points, {}); });
    brute_time += timed([&] { brute = calib::matching::search_brute_force(c.field, c.points, {}); });
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

/// Score lost and time taken by a climb from the window's centre, beside brute force over the whole window.
void print_climb(double cell, const calib::matching::SearchWindow& window,
                 const calib::matching::ClimbOptions& options) {
  std::mt19937 engine(2);
  double brute_time = 0.0, climb_time = 0.0, gap = 0.0;
  unsigned lost = 0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    const Case c = random_case(engine, seed, {window.half_width, window.half_width, window.half_angle}, cell);
    calib::matching::SearchResult brute, climb;
    brute_time += timed([&] { brute = calib::matching::search_brute_force(c.field, c.points, window); });
    climb_time += timed([&] { climb = calib::matching::search_hill_climb(c.field, c.points, {}, options); });
    gap += brute.score - climb.score;
    const Pose error = calib::math::between(c.motion, climb.pose);
    if (std::hypot(error.x, error.y) > 0.1 || std::abs(calib::math::wrap_angle(error.yaw)) > 0.05) ++lost;
  }
  std::printf(
      "| %.0f cm | %.2f m, %.0f deg | %.0f cm, %.1f deg, %d | %+.3f | %.1f %% | %.2f | %.3f | %.0f |\n",
      100.0 * cell, window.half_width, kDegrees * window.half_angle, 100.0 * options.step,
      kDegrees * options.angle_step, options.halvings, gap / kCases, 100.0 * lost / kCases,
      1e3 * brute_time / kCases, 1e3 * climb_time / kCases, brute_time / climb_time);
}

void sweep_climbs() {
  std::puts(
      "| cells | window, +- | first steps, halvings | score given away | ends elsewhere | brute force, ms | "
      "climb, ms | faster |");
  for (const double cell : {0.1, 0.05})
    for (const double width : {0.1, 0.3, 1.0})
      for (const double step : {0.05, 0.2})
        for (const int halvings : {1, 4})
          print_climb(cell, {.half_width = width, .half_angle = 0.7 * width},
                      {.step = step, .angle_step = 0.2 * step, .halvings = halvings});
}

/// Scans 5 cm and 3 degrees apart, every reading's neighbour within 10 cm. Whether all are the same.
bool compare_nearest(int beams) {
  constexpr unsigned kScans = 200;
  constexpr double kReach = 0.1;  // m
  double tree_time = 0.0, order_time = 0.0, queries = 0.0;
  bool same = true;
  for (unsigned seed = 1; seed <= kScans; ++seed) {
    const auto points = points_of(test_support::scan_from(test_support::kRoom, {}, 0.01, seed, beams), 1);
    const auto others = points_of(
        test_support::scan_from(test_support::kRoom, {0.05, 0.0, 0.05}, 0.01, seed + kScans, beams), 1);
    std::vector<double> by_tree, by_order;
    by_tree.reserve(others.size());
    by_order.reserve(others.size());
    tree_time += timed([&] {
      const calib::matching::NearestTree tree(points);
      for (const Eigen::Vector2d& p : others) {
        const double squared = tree.nearest(p).squared_distance;
        by_tree.push_back(squared <= kReach * kReach ? squared : -1.0);
      }
    });
    order_time += timed([&] {
      const calib::matching::BearingOrder order(points);
      for (const Eigen::Vector2d& p : others) {
        const auto nearest = order.nearest(p, kReach);
        by_order.push_back(nearest ? nearest->squared_distance : -1.0);
      }
    });
    queries += static_cast<double>(others.size());
    same = same && by_tree == by_order;
  }
  std::printf("nearest of %d beams, made and asked once for each: kd-tree %.0f ns, bearings %.0f ns; %s\n",
              beams, 1e9 * tree_time / queries, 1e9 * order_time / queries,
              same ? "the same" : "NOT THE SAME");
  return same;
}

}  // namespace

int main() {
  const bool coarse = compare(0.1), fine = compare(0.05);
  const bool few = compare_nearest(360), many = compare_nearest(1440);
  sweep_climbs();
  return coarse && fine && few && many ? 0 : 1;
}
