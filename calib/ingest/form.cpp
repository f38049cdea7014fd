#include "calib/ingest/form.hpp"

#include "calib/ingest/even_stamps.hpp"

namespace odomcalib::calib::ingest {

const char* name_of(Form form) {
  constexpr std::array<const char*, kForms> kNames = {"ticks",    "wheels", "wheel_speeds",
                                                      "odometry", "pose",   "scan"};
  return kNames.at(static_cast<std::size_t>(form));
}

const char* many_of(Form form) {
  constexpr std::array<const char*, kForms> kMany = {"ticks",          "wheel angles", "wheel speeds",
                                                     "odometry poses", "poses",        "scans"};
  return kMany.at(static_cast<std::size_t>(form));
}

Form motion_of(const Recording& recording) {
  switch (recording.motion) {
    case MotionSource::wheels:
      return Form::wheels;
    case MotionSource::wheel_speeds:
      return Form::wheel_speeds;
    case MotionSource::odometry:
      return Form::odometry;
    case MotionSource::ticks:
      break;
  }
  return Form::ticks;
}

Form reference_of(const Recording& recording) { return recording.poses.empty() ? Form::scan : Form::pose; }

std::vector<double> stamps_of(const Recording& recording, Form form) {
  switch (form) {
    case Form::ticks:
      return recording.motion == MotionSource::ticks ? stamps_of(recording.ticks) : std::vector<double>{};
    case Form::wheels:
      return stamps_of(recording.wheels);
    case Form::wheel_speeds:
      return stamps_of(recording.wheel_speeds);
    case Form::odometry:
      return stamps_of(recording.odometry);
    case Form::pose:
      return stamps_of(recording.poses);
    case Form::scan:
      break;
  }
  return stamps_of(recording.scans);
}

std::size_t left_out(const Recording& recording, Form form, const char* reason) {
  std::size_t count = 0;
  for (const Discarded& discarded : recording.discarded)
    if (discarded.what == name_of(form) && discarded.reason == reason) count += discarded.count;
  return count;
}

}  // namespace odomcalib::calib::ingest
