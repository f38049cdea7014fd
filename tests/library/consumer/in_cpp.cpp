// Every call of the C++ header, as a program outside of the tree makes it. Reads "stamp left right" lines and
// prints the last pose.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <odomcalib/odometry.hpp>

namespace {

void check(bool holds, const char* what) {
  if (holds) return;
  std::cerr << what << " does not hold\n";
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  check(argc == 2, "one argument");
  const auto missing = odomcalib::Odometry::open("/nowhere.json");
  check(!missing && missing.error().status == ODOMCALIB_CANNOT_READ, "a file that is missing is an error");
  check(!odomcalib::Odometry::from_text("{}"), "an empty text is an error");
  odomcalib_options options = ODOMCALIB_OPTIONS_INIT;
  options.counter_bits = 32;
  auto opened = odomcalib::Odometry::open(argv[1], options);
  if (!opened) {
    std::cerr << opened.error().text << '\n';
    return 1;
  }
  odomcalib::Odometry odometry = std::move(*opened);
  double stamp = 0.0;
  long long left = 0, right = 0;
  while (std::scanf("%lf %lld %lld", &stamp, &left, &right) == 3)
    check(odometry.update_counts(stamp, left, right) == ODOMCALIB_OK, odometry.problem());
  const odomcalib::Pose pose = odometry.pose();
  std::printf("%.17g %.17g %.17g\n", pose.x, pose.y, pose.yaw);

  check(odometry.stamp() == stamp, "the stamp");
  check(odometry.covariance()[0] > 0.0 && odometry.covariance_is_whole(), "the covariance");
  check(odometry.lidar_pose().has_value(), "the lidar pose");
  check(!odometry.effects().empty() && odometry.effects()[0].place == ODOMCALIB_IN_POSE, "the effects");
  check(odometry.update_angles(stamp + 1.0, 0.0, 0.0) == ODOMCALIB_OTHER_MOTION,
        "kinds of motion do not mix");
  check(odometry.update_counts(stamp, left, right) == ODOMCALIB_STAMP_NOT_LATER, "a stamp that is not later");
  check(odometry.set_pose({1.0, 2.0, 0.5}) == ODOMCALIB_OK && odometry.pose().y == 2.0, "a pose that is set");
  check(odometry.covariance()[0] == 0.0, "is certain");
  odometry.restart();
  std::vector<float> bearings{0.0F}, ranges{1.0F};
  odometry.correct_beams(bearings, ranges);
  check(ranges[0] == 1.0F && odometry.clock_offset() == 0.0, "a lidar without errors");
  odomcalib::Odometry moved = std::move(odometry);
  check(moved.velocity().forward == moved.velocity().forward && moved.velocity_covariance().size() == 9,
        "velocity");
  return 0;
}
