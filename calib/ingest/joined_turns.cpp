#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"
#include "proto/recording/scan_parts.hpp"

namespace odomcalib::calib::ingest {
namespace {

/// Where a message looks; its beams stand in the order in which they were measured.
struct Part {
  double first = 0.0, last = 0.0;  ///< bearings of its first and last beam, rad
  double step = 0.0;               ///< rad from beam to beam in the mean, negative for a clockwise lidar
  double width = 0.0;              ///< rad, with the way to the next beam
  bool is_grid = false;            ///< nothing is stated beam by beam
};

Part part_of(const Scan& scan) {
  Part part;
  if (scan.ranges.empty()) return part;
  part.is_grid = scan.angles.empty() && scan.times.empty();
  part.step = mean_step(scan);
  part.width = std::abs(part.step) * static_cast<double>(scan.ranges.size());
  part.first = scan.angle(0);
  part.last = scan.angle(scan.ranges.size() - 1);
  return part;
}

/// Whether the first beam of one is the next after the last beam of the other, all the way round.
bool goes_on(const Part& before, const Part& after) {
  const double same = before.is_grid && after.is_grid ? settings::kSameStep : kSameStepOfParts;
  if (!(std::abs(before.step) > 0.0)) return false;
  if (std::abs(after.step - before.step) > same * std::abs(before.step)) return false;
  return std::abs(math::wrap_angle(after.first - before.last - before.step)) <
         kNextBeamOfParts * std::abs(before.step);
}

bool begins_at(const Part& part, double bearing) {
  return std::abs(math::wrap_angle(part.first - bearing)) < 0.5 * part.width;
}

/// The sweep that comes back again and again.
struct Sweep {
  double start = 0.0;  ///< bearing of its first beam, rad
  double width = kWholeTurn;
};

/// Messages of one sensor, each with whether it goes on where the one before ended.
struct Messages {
  std::vector<Part> parts;
  std::vector<bool> follows;
};

Messages messages_of(const std::vector<Scan>& scans) {
  Messages messages;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    messages.parts.push_back(part_of(scans[k]));
    messages.follows.push_back(k > 0 && scans[k].sensor == scans[k - 1].sensor &&
                               goes_on(messages.parts[k - 1], messages.parts[k]));
  }
  return messages;
}

/// rad, as most messages have.
double usual_part(const Messages& messages) {
  std::vector<double> widths;
  for (const Part& part : messages.parts) widths.push_back(part.width);
  return math::median_of(std::move(widths));
}

struct Start {
  double bearing = 0.0;
  std::size_t times = 0;  ///< a message that does not go on begins there
};

Start usual_start(const Messages& messages) {
  Start usual;
  std::size_t candidates = 0;
  for (std::size_t k = 1; k < messages.parts.size() && candidates < settings::kFewestParts; ++k) {
    if (messages.follows[k]) continue;
    ++candidates;
    Start start{messages.parts[k].first, 0};
    for (std::size_t i = 1; i < messages.parts.size(); ++i)
      if (!messages.follows[i] && begins_at(messages.parts[i], start.bearing)) ++start.times;
    if (start.times > usual.times) usual = start;
  }
  return usual;
}

/// Width of the sweeps that begin at the bearing, up to the message that does not go on; rad.
double usual_width(const Messages& messages, double start) {
  std::vector<double> widths;
  for (std::size_t k = 1; k < messages.parts.size(); ++k)
    if (!messages.follows[k] && begins_at(messages.parts[k], start))
      widths.push_back(messages.parts[k].width);
    else if (messages.follows[k] && !widths.empty())
      widths.back() += messages.parts[k].width;
  return widths.empty() ? 0.0 : math::median_of(std::move(widths));
}

/// The lidar's view begins at one bearing, and ends before a whole turn: most messages that do not go on
/// begin there, and the others follow a lost one.
std::optional<Sweep> part_of_turn(const Messages& messages) {
  const std::size_t steps = messages.parts.size() - 1;
  const auto following =
      static_cast<std::size_t>(std::count(messages.follows.begin(), messages.follows.end(), true));
  const Start start = usual_start(messages);
  const auto beginning = static_cast<double>(start.times), all = static_cast<double>(following) + beginning;
  if (2 * start.times <= steps - following || all < settings::kFollowingParts * static_cast<double>(steps) ||
      all < settings::kFewestPartsOfTurn * beginning)
    return std::nullopt;
  const Sweep sweep{start.bearing, usual_width(messages, start.bearing)};
  return sweep.width < kWholeTurn - 0.5 * usual_part(messages) ? std::optional(sweep) : std::nullopt;
}

std::optional<Sweep> whole_turn(const Messages& messages) {
  const auto steps = static_cast<double>(messages.parts.size() - 1);
  const auto following =
      static_cast<double>(std::count(messages.follows.begin(), messages.follows.end(), true));
  if (following < settings::kFollowingParts * steps ||
      kWholeTurn < settings::kFewestPartsOfTurn * usual_part(messages))
    return std::nullopt;
  return Sweep{messages.parts.front().first, kWholeTurn};
}

/// Messages go on where the one before ended, until the first bearing comes back.
std::optional<Sweep> sweep_of(const Messages& messages) {
  if (messages.parts.size() < settings::kFewestParts) return std::nullopt;
  const std::optional<Sweep> sweep = part_of_turn(messages);
  return sweep ? sweep : whole_turn(messages);
}

/// s, from a message to the next of the same sweep.
double interval_of(const std::vector<Scan>& scans, const Messages& messages) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < scans.size(); ++k)
    if (messages.follows[k]) intervals.push_back(scans[k].t - scans[k - 1].t);
  return intervals.empty() ? 0.0 : math::median_of(std::move(intervals));
}

/// A sweep begins where the first one did, and ends where another message would begin again.
class Sweeps {
 public:
  Sweeps(const std::vector<Scan>& scans, const Messages& messages, const Sweep& sweep)
      : scans_(scans), messages_(messages), sweep_(sweep), interval_(interval_of(scans, messages)) {
    for (std::size_t k = 0; k < scans.size(); ++k) add(k);
    end();
  }

  [[nodiscard]] std::vector<Scan> take() { return std::move(done_); }
  [[nodiscard]] const Discarded& lost() const { return lost_; }
  /// Messages of a sweep, as most have.
  [[nodiscard]] std::size_t usual_pieces() const {
    return done_.empty() ? 0 : static_cast<std::size_t>(std::lround(math::median_of(pieces_)));
  }

 private:
  void add(std::size_t k) {
    const Part& part = messages_.parts[k];
    if (first_ && !(messages_.follows[k] && lacks(0.5 * part.width))) end();
    if (!first_ && !begins_at(part, sweep_.start)) return lose(k);
    if (!first_) first_ = k;
    last_ = k;
    swept_ += part.width;
  }

  [[nodiscard]] bool lacks(double width) const { return swept_ + width < sweep_.width; }
  void lose(std::size_t k) { count_one(lost_, scans_[k].t); }

  void end() {
    if (!first_) return;
    if (lacks(0.5 * messages_.parts[last_].width))
      for (std::size_t k = *first_; k <= last_; ++k) lose(k);
    else
      close();
    first_.reset();
    swept_ = 0.0;
  }

  void close() {
    bool is_grid = true;
    for (std::size_t k = *first_; k <= last_; ++k) is_grid = is_grid && messages_.parts[k].is_grid;
    done_.push_back(is_grid ? on_grid() : beam_by_beam());
    pieces_.push_back(static_cast<double>(last_ - *first_ + 1));
  }

  [[nodiscard]] Scan on_grid() const {
    Scan sweep = scans_[*first_];
    sweep.intensities.clear();
    for (std::size_t k = *first_ + 1; k <= last_; ++k)
      sweep.ranges.insert(sweep.ranges.end(), scans_[k].ranges.begin(), scans_[k].ranges.end());
    if (!sweep.time_increment)
      sweep.time_increment =
          interval_ * static_cast<double>(last_ - *first_ + 1) / static_cast<double>(sweep.ranges.size());
    return sweep;
  }

  /// s, of a beam after its message's stamp.
  [[nodiscard]] double time_of(const Scan& part, std::size_t beam) const {
    if (!part.times.empty()) return static_cast<double>(part.times[beam]);
    const auto number = static_cast<double>(beam);
    return part.time_increment ? *part.time_increment * number
                               : interval_ * number / static_cast<double>(part.ranges.size());
  }

  [[nodiscard]] Scan beam_by_beam() const {
    Scan sweep = scans_[*first_];
    sweep.angle_min = messages_.parts[*first_].first;
    sweep.angle_increment = messages_.parts[*first_].step;
    sweep.time_increment.reset();
    for (auto* list : {&sweep.ranges, &sweep.angles, &sweep.times, &sweep.intensities}) list->clear();
    for (std::size_t k = *first_; k <= last_; ++k) {
      const Scan& part = scans_[k];
      for (std::size_t beam = 0; beam < part.ranges.size(); ++beam) {
        sweep.ranges.push_back(part.ranges[beam]);
        sweep.angles.push_back(static_cast<float>(part.angle(beam)));
        sweep.times.push_back(static_cast<float>(part.t - sweep.t + time_of(part, beam)));
      }
    }
    return sweep;
  }

  const std::vector<Scan>& scans_;
  const Messages& messages_;
  Sweep sweep_;
  double interval_;
  std::optional<std::size_t> first_;  ///< of the messages of the sweep that is open
  std::size_t last_ = 0;
  double swept_ = 0.0;  ///< rad
  std::vector<Scan> done_;
  std::vector<double> pieces_;
  Discarded lost_{"scan", "part of a turn without its other parts"};
};

std::string degrees_of(double angle) { return math::significant(angle * 180.0 / math::kPi, 3); }

std::string said_of(const Sweep& sweep, std::size_t parts) {
  const bool is_turn = sweep.width >= kWholeTurn;
  return (is_turn ? "a turn" : "a sweep of " + degrees_of(sweep.width) + " degrees") + " comes in " +
         std::to_string(parts) + " messages: their first beam steps by " +
         degrees_of(sweep.width / static_cast<double>(parts)) + " degrees in the mean";
}

}  // namespace

std::optional<Recording> with_joined_turns(const Recording& recording) {
  const Messages messages = messages_of(recording.scans);
  const std::optional<Sweep> sweep = sweep_of(messages);
  if (!sweep) return std::nullopt;
  Sweeps sweeps(recording.scans, messages, *sweep);
  const std::size_t parts = sweeps.usual_pieces();
  Discarded lost = sweeps.lost();
  if (parts < 2 || 2 * lost.count > recording.scans.size()) return std::nullopt;
  Recording joined = recording;
  joined.scans = sweeps.take();
  if (lost.count > 0) {
    lost.of = recording.scans.size();
    joined.discarded.push_back(lost);
  }
  joined.repairs.push_back(
      {"turns", "joined from " + std::to_string(parts) + " parts each", said_of(*sweep, parts)});
  return joined;
}

}  // namespace odomcalib::calib::ingest
