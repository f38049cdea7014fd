/* Corrected odometry in a control loop in C: lines "stamp left right" (s, cumulative counts) on standard input, a
 * line "stamp x y yaw forward yaw_rate" for each on standard output.
 *
 *   cc control_loop.c $(pkg-config --cflags --libs odomcalib) -o control_loop
 *   ./control_loop cal.json < counts.txt
 */
#include <inttypes.h>
#include <odomcalib/odometry.h>
#include <stdio.h>

int main(int argc, char** argv) {
  odomcalib_odometry* odometry = NULL;
  char problem[256];
  if (argc != 2 || odomcalib_odometry_open(argv[1], NULL, &odometry, problem, sizeof problem) != ODOMCALIB_OK) {
    fprintf(stderr, "%s\n", argc == 2 ? problem : "usage: control_loop CALIBRATION");
    return 1;
  }
  for (size_t k = 0; k < odomcalib_odometry_effect_count(odometry); ++k) {
    odomcalib_effect effect = {.size = sizeof effect};
    if (odomcalib_odometry_effect(odometry, k, &effect) == ODOMCALIB_OK && effect.place == ODOMCALIB_LEFT_OUT)
      fprintf(stderr, "left out: %s: %s\n", effect.name, effect.why);
  }

  double stamp;
  int64_t left, right;
  while (scanf("%lf %" SCNd64 " %" SCNd64, &stamp, &left, &right) == 3) {
    double pose[3], velocity[3];
    /* A sample that cannot be used leaves the pose as it is; the next good one goes on. */
    if (odomcalib_odometry_update_counts(odometry, stamp, left, right) != ODOMCALIB_OK)
      fprintf(stderr, "%s\n", odomcalib_odometry_problem(odometry));
    odomcalib_odometry_pose(odometry, pose);
    odomcalib_odometry_velocity(odometry, velocity);
    printf("%.6f %.17g %.17g %.17g %.9g %.9g\n", stamp, pose[0], pose[1], pose[2], velocity[0], velocity[2]);
  }
  odomcalib_odometry_close(odometry);
  return 0;
}
