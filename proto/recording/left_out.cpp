#include "proto/recording/left_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "proto/number_text.hpp"

namespace odomcalib {
namespace {

struct Kind {
  std::string_view what;
  std::string_view several;  ///< as a person calls them
  bool motion = false;       ///< the wheels' motion is computed from these
};

/// Parts of a recording that are of use for a calibration. The rest of a file (messages of other topics, a
/// second robot line) is nobody's loss, and a lidar in an open room has empty beams.
constexpr std::array kKinds = {Kind{kInterval, "intervals between counts", true},
                               Kind{"ticks", "counts", true},
                               Kind{"wheels", "wheel angles", true},
                               Kind{"wheel_speeds", "wheel speeds", true},
                               Kind{"odometry", "poses of odometry", true},
                               Kind{"scan", "scans"},
                               Kind{"pose", "poses"},
                               Kind{"gyro", "gyro readings"},
                               Kind{"tuple", "tuples"},
                               Kind{"line", "lines"},
                               Kind{"chunk", "chunks of the file"},
                               Kind{"file", "file"},
                               Kind{"pair", "pairs"}};

const Kind* kind_of(const Discarded& one) {
  const auto* found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) { return kind.what == one.what; });
  return found == kKinds.end() ? nullptr : found;
}

/// Two digits tell a second from another; whole seconds are enough later on.
std::string seconds_text(double t) { return std::abs(t) < 10.0 ? printed("%.1f", t) : printed("%.0f", t); }

std::string percent_text(double share) {
  return (share < 0.1 ? printed("%.2g", 100.0 * share) : printed("%.0f", 100.0 * share)) + " %";
}

}  // namespace

bool is_end_of_file(const Discarded& one) { return one.reason.ends_with("cut off"); }

void tell_where_it_ends(Recording& recording) {
  std::optional<double> last;
  const auto look = [&](const auto& samples) {
    if (!samples.empty()) last = std::max(last.value_or(samples.back().t), samples.back().t);
  };
  look(recording.ticks);
  look(recording.scans);
  look(recording.poses);
  for (Discarded& one : recording.discarded)
    if (last && is_end_of_file(one) && !one.begin) include(one, *last);
}

std::vector<Discarded> left_out_of(const Recording& recording) {
  std::vector<Discarded> all = recording.discarded;
  for (Discarded& one : all)
    if (one.what == "ticks" && one.reason == kUncontinued) one.what = kInterval;
  return all;
}

bool is_loss(const Discarded& one) {
  const bool is_replaced = one.reason.ends_with(kFinerDecides) || one.reason.ends_with(kOfSecondProgram) ||
                           one.reason.ends_with(kOfAnotherSensor);
  return one.count > one.copies && (kind_of(one) != nullptr || is_end_of_file(one)) && !is_replaced;
}

bool is_loss_of_motion(const Discarded& one) {
  const Kind* kind = kind_of(one);
  return is_loss(one) && kind != nullptr && kind->motion;
}

double share_of(const Discarded& one) {
  return one.of > 0 ? static_cast<double>(one.count - one.copies) / static_cast<double>(one.of) : 0.0;
}

std::string to_text(const Discarded& one, std::optional<double> start) {
  if (is_end_of_file(one) && one.begin)
    return "the file from " + seconds_text(*one.begin - start.value_or(0.0)) + " s on: " + one.reason;
  const Kind* kind = kind_of(one);
  std::string text = std::to_string(one.count);
  if (one.of > 0) text += " of " + std::to_string(one.of);
  text += " " + (kind != nullptr ? std::string(kind->several) : one.what);
  if (one.of > 0)
    text += " (" + percent_text(static_cast<double>(one.count) / static_cast<double>(one.of)) + ")";
  if (one.copies > 0) text += ", " + std::to_string(one.copies) + " of them the same again";
  if (one.begin && one.end) {
    const double zero = start.value_or(0.0);
    text += *one.begin < *one.end
                ? ", from " + seconds_text(*one.begin - zero) + " to " + seconds_text(*one.end - zero)
                : ", at " + seconds_text(*one.begin - zero);
    text += " s";
  }
  return text + ": " + one.reason;
}

}  // namespace odomcalib
