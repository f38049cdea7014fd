/* Corrected odometry with a calibration of odomcalib: wheel counts, angles or speeds with time stamps in, one at
 * a time; pose, velocity and their covariances out. The same code as `odomcalibctl predict --live` and odomcalibd,
 * to the last bit.
 *
 * Units: m, rad, s, m/s, rad/s. Axes: x forward, y left, yaw counter-clockwise (REP-103). Poses are those of the
 * base, the middle between the two driven wheels.
 *
 * Every function returns ODOMCALIB_OK or what is wrong; odomcalib_odometry_problem() then says it in words. After an
 * error of an update the pose is what it was, and the next good sample goes on.
 *
 * A handle belongs to one thread at a time; several handles have nothing in common. Updates of a drive and what is asked
 * of its pose take no memory, lock nothing and throw nothing.
 */
#ifndef ODOMCALIB_ODOMETRY_H
#define ODOMCALIB_ODOMETRY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ODOMCALIB_EXPORT __attribute__((visibility("default")))

typedef struct odomcalib_odometry odomcalib_odometry;

enum {
  ODOMCALIB_OK = 0,
  ODOMCALIB_INVALID_ARGUMENT = 1,  /* a null pointer, an unknown option, one that does not fit the others */
  ODOMCALIB_CANNOT_READ = 2,       /* the file cannot be opened or read */
  ODOMCALIB_NOT_A_CALIBRATION = 3, /* damaged, or none; or without what odometry needs */
  ODOMCALIB_OTHER_VERSION = 4,     /* of a version of the format that this library does not read */
  ODOMCALIB_REFUSED = 5,           /* the calibration says of itself that it is not to be used */
  ODOMCALIB_NOT_A_NUMBER = 6,      /* NaN, infinity or a count beyond 2^53: the sample was not taken in */
  ODOMCALIB_STAMP_NOT_LATER = 7,   /* the sample is no later than the one before: it was not taken in */
  ODOMCALIB_JUMP = 8,              /* no wheel turns so far in that time: the sample was not taken in */
  ODOMCALIB_OTHER_MOTION = 9,      /* counts, angles and speeds do not mix in one drive */
  ODOMCALIB_NOT_KNOWN = 10,        /* the calibration does not say it */
  ODOMCALIB_NO_MEMORY = 11,
  ODOMCALIB_INTERNAL = 12          /* an error of the library */
};

/* Name of a status without its prefix, for logs: "JUMP". Never null. */
ODOMCALIB_EXPORT const char* odomcalib_status_name(int status);
/* Version of the library, "0.2.0". */
ODOMCALIB_EXPORT const char* odomcalib_version(void);

typedef struct odomcalib_options {
  size_t size;            /* sizeof(odomcalib_options): later versions may have more members */
  double counts_per_turn; /* of a wheel; 0: as the calibration says */
  int counter_bits;       /* 8 to 32: counts wrap there, signed or unsigned; 0: they do not */
  int use_refused;        /* 1: open a calibration that was refused, too */
} odomcalib_options;
#define ODOMCALIB_OPTIONS_INIT {sizeof(odomcalib_options), 0.0, 0, 0}

/* Opens a calibration file. On success *odometry is a handle for odomcalib_odometry_close(); otherwise null, and
 * `problem` (may be null) holds the reason, cut off at `size` bytes with the terminating zero.
 * options: may be null. */
ODOMCALIB_EXPORT int odomcalib_odometry_open(const char* path, const odomcalib_options* options,
                                             odomcalib_odometry** odometry, char* problem, size_t size);
/* The same of the file's text. */
ODOMCALIB_EXPORT int odomcalib_odometry_open_text(const char* text, size_t length, const odomcalib_options* options,
                                                  odomcalib_odometry** odometry, char* problem, size_t size);
/* Null is allowed. */
ODOMCALIB_EXPORT void odomcalib_odometry_close(odomcalib_odometry* odometry);

/* Takes a sample in; the first one defines the origin. `stamp`: s, by whatever clock, rising.
 * Counts: cumulative, forward counts up on both sides. A jump that lasts is a counter that was reset: the second
 * sample after it goes on from there, without motion in between; one that does not last was read wrong, and nothing
 * is lost. The same goes for stamps. */
ODOMCALIB_EXPORT int odomcalib_odometry_update_counts(odomcalib_odometry* odometry, double stamp, int64_t left,
                                                      int64_t right);
/* Cumulative wheel angles, rad, not cut off at a turn. They are rounded to counts of the calibration. */
ODOMCALIB_EXPORT int odomcalib_odometry_update_angles(odomcalib_odometry* odometry, double stamp, double left,
                                                      double right);
/* Wheel speeds, rad/s, each held until the next sample. */
ODOMCALIB_EXPORT int odomcalib_odometry_update_speeds(odomcalib_odometry* odometry, double stamp, double left,
                                                      double right);
/* The counters are about to start anew, or the clock: the next sample goes on from the last pose, without motion in
 * between. */
ODOMCALIB_EXPORT int odomcalib_odometry_restart(odomcalib_odometry* odometry);
/* The pose is now that one, x, y, yaw, and certain: its covariance begins at zero. */
ODOMCALIB_EXPORT int odomcalib_odometry_set_pose(odomcalib_odometry* odometry, const double pose[3]);

/* Stamp of the last sample that was taken in, s; 0 before the first. */
ODOMCALIB_EXPORT double odomcalib_odometry_stamp(const odomcalib_odometry* odometry);
/* x, y, yaw in (-pi, pi], in the frame of the origin. */
ODOMCALIB_EXPORT int odomcalib_odometry_pose(const odomcalib_odometry* odometry, double pose[3]);
/* Forward, to the left, yaw rate: means over the last interval. */
ODOMCALIB_EXPORT int odomcalib_odometry_velocity(const odomcalib_odometry* odometry, double velocity[3]);
/* Row by row, of x, y, yaw: what the contact of wheels and floor adds by chance (the calibration's `contact_noise`)
 * and what the parameters' uncertainty makes of the way, both to first order, against the metre of the reference that
 * was calibrated with. ODOMCALIB_NOT_KNOWN, and the part that is known, where the file has only one of both. */
ODOMCALIB_EXPORT int odomcalib_odometry_covariance(const odomcalib_odometry* odometry, double covariance[9]);
/* The same of the velocity. */
ODOMCALIB_EXPORT int odomcalib_odometry_velocity_covariance(const odomcalib_odometry* odometry, double covariance[9]);

/* Pose of the lidar on the base: x, y, yaw. */
ODOMCALIB_EXPORT int odomcalib_odometry_lidar_pose(const odomcalib_odometry* odometry, double pose[3]);
/* Offset of the lidar's clock, s: a scan stamped t was taken at t - offset by the encoders' clock; 0 where the
 * calibration found none. */
ODOMCALIB_EXPORT double odomcalib_odometry_clock_offset(const odomcalib_odometry* odometry);
/* Beams as they would be without the errors of the lidar that the calibration knows and can correct: bearings and
 * ranges, rad and m, in the lidar's axes. Ranges of 0 and below are no readings and stay. Output may be the input. */
ODOMCALIB_EXPORT int odomcalib_odometry_correct_beams(const odomcalib_odometry* odometry, size_t count,
                                                      const float* bearings, const float* ranges,
                                                      float* corrected_bearings, float* corrected_ranges);

enum {
  ODOMCALIB_IN_POSE = 0,  /* applied in pose and velocity */
  ODOMCALIB_IN_SCANS = 1, /* applied in odomcalib_odometry_correct_beams() */
  ODOMCALIB_IN_STAMPS = 2, /* told by odomcalib_odometry_clock_offset() */
  ODOMCALIB_LEFT_OUT = 3  /* nowhere; `why` says why */
};
typedef struct odomcalib_effect {
  size_t size;      /* sizeof(odomcalib_effect), filled in by the caller */
  const char* name; /* as in the file, "backlash.left_play"; valid until the handle is closed */
  double value;
  const char* unit;
  int place;       /* ODOMCALIB_IN_POSE ... */
  const char* why; /* of what is left out; empty otherwise */
} odomcalib_effect;
/* Values of effects in the calibration. */
ODOMCALIB_EXPORT size_t odomcalib_odometry_effect_count(const odomcalib_odometry* odometry);
ODOMCALIB_EXPORT int odomcalib_odometry_effect(const odomcalib_odometry* odometry, size_t index,
                                               odomcalib_effect* effect);

/* What was wrong with the last update or restart, in words; empty after a good one. Valid until the next call. */
ODOMCALIB_EXPORT const char* odomcalib_odometry_problem(const odomcalib_odometry* odometry);

/* Poses of a whole recording at once, as `odomcalibctl predict` has them: effects that act by speeds see those before
 * and after each sample. `stamps`, `left`, `right`: `count` each. `poses`: x, y, yaw for each sample, 3 * count.
 * The handle's own pose is none of it. Takes memory. */
ODOMCALIB_EXPORT int odomcalib_odometry_path(const odomcalib_odometry* odometry, size_t count, const double* stamps,
                                             const int64_t* left, const int64_t* right, double* poses);

#ifdef __cplusplus
}
#endif

#endif
