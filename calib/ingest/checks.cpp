#include "calib/ingest/checks.hpp"

#include "calib/ingest/frames.hpp"
#include "calib/ingest/stamp_check.hpp"
#include "calib/ingest/unit_check.hpp"

namespace odomcalib::calib::ingest {
namespace {

template <Form form>
std::optional<Error> digits(const Recording& recording) {
  return lost_digits(recording, form);
}

template <Form form>
std::optional<Error> clock_set(const Recording& recording) {
  return clock_was_set(recording, form);
}

std::optional<Error> wrong_scan_times(const Recording& recording) {
  if (auto error = scans_too_fast(recording)) return error;
  if (auto error = spans_in_units(recording)) return error;
  return slow_beams(recording);
}

std::optional<Error> wrong_scan_values(const Recording& recording) {
  if (auto error = too_many_turns(recording)) return error;
  if (auto error = wrong_ranges(recording)) return error;
  return wrong_lidar_pose(recording);
}

constexpr Cell told(Check check) { return {Answer::told, "", check}; }
constexpr Cell mended(const char* how) { return {Answer::mended, how}; }
constexpr Cell measured(const char* how = "") { return {Answer::measured, how}; }
constexpr Cell counted(const char* how = "") { return {Answer::counted, how}; }
constexpr Cell cannot(const char* why) { return {Answer::cannot, why}; }

constexpr Cell kAnyCounts = cannot("any two counts are a motion of two wheels");
constexpr Cell kNoWheels = cannot("says nothing of wheels");
constexpr Cell kOneValue = cannot("is one value, not a turn of beams");
constexpr Cell kStands = cannot("a wheel that stands repeats its value; only changes are read");

// In the order in which they are looked for: what makes others look wrong comes first.
constexpr std::array kFaults = {
    Fault{"lost_digits",
          "stamps without their last digits, or all equal",
          {told(digits<Form::ticks>), told(digits<Form::wheels>), told(digits<Form::wheel_speeds>),
           told(digits<Form::odometry>), told(digits<Form::pose>), told(digits<Form::scan>)}},
    Fault{"clock_was_set",
          "a clock since boot, set to the date while recording",
          {told(clock_set<Form::ticks>), told(clock_set<Form::wheels>), told(clock_set<Form::wheel_speeds>),
           told(clock_set<Form::odometry>), told(clock_set<Form::pose>), told(clock_set<Form::scan>)}},
    Fault{"time_unit",
          "times in milliseconds, microseconds, nanoseconds or minutes",
          {told(spans_in_units), told(spans_in_units), told(spans_in_units), told(spans_in_units),
           told(spans_in_units), told(wrong_scan_times)}},
    Fault{"clock_step",
          "a clock that is set by less than an hour",
          {measured(), measured(), measured(), measured(), measured(), measured()}},
    Fault{"clock_rate",
          "a clock that runs too fast or too slowly, or is late",
          {measured(), measured(), measured(), measured(), measured(), measured()}},
    Fault{"order",
          "samples out of order by more than a second",
          {counted(), counted(), counted(), counted(), counted(), counted()}},
    Fault{"second_writer",
          "a second program writes one value in between",
          {mended("left out"), mended("left out"), mended("left out"), mended("left out"), mended("left out"),
           cannot("a scan that is always the same is a repeated one")}},
    Fault{"repeated",
          "the value before sent again with a new stamp",
          {kStands, kStands, cannot("a speed holds until the next one"), kStands,
           mended("left out where the wheels turned"), mended("left out where the wheels turned")}},
    Fault{"several_sources",
          "several sensors or frames on one topic",
          {cannot("counts carry no name"), mended("by the names of joints"), mended("by the names of joints"),
           mended("the frame with most messages"), mended("the frame with most messages"),
           mended("the sensor with most scans, or --sensor")}},
    Fault{"value_unit",
          "values in another unit",
          {measured("ticks_per_rev, or the gear"), measured("turns, degrees, m, mm"),
           measured("rpm, rpm times 10, turns, degrees, m, mm"), measured("cm, mm, inches, feet"),
           measured("mm, cm, inches, feet"), told(wrong_scan_values)}},
    Fault{"heading_unit",
          "a yaw in degrees, negated, of a compass, a quarter of a turn off, or half",
          {kAnyCounts, kAnyCounts, kAnyCounts, told(wrong_odometry_heading), told(wrong_pose_frame),
           cannot("states no heading")}},
    Fault{"not_of_two_wheels",
          "a motion that two wheels cannot make",
          {kAnyCounts, kAnyCounts, kAnyCounts, told(wrong_odometry_frame),
           mended("where the reference sits is fitted"), cannot("states no motion")}},
    Fault{"counter_wraps",
          "a counter that starts again",
          {mended("at 2^16, 2^32 or a number of its own"), mended("after one turn"),
           cannot("speeds are not counted"), mended("yaw, after one turn"), mended("yaw, after one turn"),
           cannot("ranges are not counted")}},
    Fault{"no_direction",
          "counts that only grow",
          {measured(), measured(), measured(), cannot("a heading turns both ways"), kNoWheels, kNoWheels}},
    Fault{"exchanged",
          "left and right exchanged, or a wheel that counts backwards",
          {measured(), measured(), measured(), measured("yaw to the other side"), kNoWheels, kNoWheels}},
    Fault{"misread",
          "single values that no motion reaches",
          {counted("taken for what lies between"), counted("taken for what lies between"),
           counted("taken for what lies between"), counted("taken for what lies between"),
           counted("pairs that contradict all others"), counted("pairs that contradict all others")}},
    Fault{"parts",
          "a turn in several messages",
          {kOneValue, kOneValue, kOneValue, kOneValue, kOneValue, mended("joined")}},
    Fault{"wandering_head",
          "a number of beams that varies under one angle_increment",
          {kOneValue, kOneValue, kOneValue, kOneValue, kOneValue, mended("one turn by their number")}},
    Fault{"phantom",
          "a fixed distance where nothing came back",
          {kOneValue, kOneValue, kOneValue, kOneValue, kOneValue, mended("left out")}}};

bool uses(const Recording& recording, Form form) {
  if (form == Form::pose) return !recording.poses.empty();
  // Poses replace scans, whatever these are.
  if (form == Form::scan) return recording.poses.empty();
  return form == motion_of(recording);
}

}  // namespace

std::span<const Fault> faults() { return kFaults; }

const char* name_of(Answer answer) {
  switch (answer) {
    case Answer::told:
      return "told";
    case Answer::mended:
      return "mended";
    case Answer::counted:
      return "counted";
    case Answer::measured:
      return "measured";
    case Answer::cannot:
      break;
  }
  return "-";
}

std::string faults_table() {
  std::string table = "| fault |";
  std::string rule = "| --- |";
  for (std::size_t k = 0; k < kForms; ++k) {
    table += " " + std::string(name_of(static_cast<Form>(k))) + " |";
    rule += " --- |";
  }
  table += "\n" + rule + "\n";
  for (const Fault& fault : kFaults) {
    table += "| " + std::string(fault.words) + " |";
    for (const Cell& cell : fault.cells) {
      const std::string words = cell.words;
      table += " " + std::string(name_of(cell.answer)) + (words.empty() ? "" : ": " + words) + " |";
    }
    table += "\n";
  }
  return table;
}

std::optional<Error> told_fault(const Recording& recording) {
  for (const Fault& fault : kFaults)
    for (std::size_t k = 0; k < kForms; ++k) {
      const Cell& cell = fault.cells.at(k);
      if (cell.check == nullptr || !uses(recording, static_cast<Form>(k))) continue;
      if (auto error = cell.check(recording)) return error;
    }
  return std::nullopt;
}

}  // namespace odomcalib::calib::ingest
