#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/reference_faults.hpp"
#include "calib/ingest/settings.hpp"
#include "calib/math/median.hpp"
#include "calib/math/number_text.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

double width_of(const Scan& scan) {
  return std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size());
}

bool has_grid(const Scan& scan) { return scan.angles.empty() && scan.times.empty(); }

/// Whether the first beam of one is the next after the last beam of the other, all the way round.
bool goes_on(const Scan& before, const Scan& after) {
  if (!has_grid(before) || !has_grid(after) || before.sensor != after.sensor) return false;
  const double step = before.angle_increment;
  if (std::abs(after.angle_increment - step) > settings::kSameStep * std::abs(step)) return false;
  const double next = before.angle_min + step * static_cast<double>(before.ranges.size());
  return std::abs(math::wrap_angle(after.angle_min - next)) < settings::kNextBeam * std::abs(step);
}

/// In how many messages a turn comes; 1 where scans are no parts of turns.
std::size_t parts_of(const std::vector<Scan>& scans) {
  if (scans.size() < settings::kFewestParts || !has_grid(scans.front())) return 1;
  std::vector<double> widths;
  widths.reserve(scans.size());
  for (const Scan& scan : scans) widths.push_back(width_of(scan));
  const double parts = kWholeTurn / std::max(math::median_of(std::move(widths)), 1e-6);
  if (parts < settings::kFewestPartsOfTurn) return 1;
  std::size_t following = 0;
  for (std::size_t k = 1; k < scans.size(); ++k) following += goes_on(scans[k - 1], scans[k]) ? 1 : 0;
  const auto share = static_cast<double>(following) / static_cast<double>(scans.size() - 1);
  return share < settings::kFollowingParts ? 1 : static_cast<std::size_t>(std::lround(parts));
}

/// A turn begins where the first scan does, and ends where another would pass that direction again.
class Turns {
 public:
  explicit Turns(const std::vector<Scan>& parts)
      : start_(parts.front().angle_min), interval_(math::median_of(math::differences_of(stamps_of(parts)))) {}

  void add(const Scan& part) {
    if (open_ && !goes_on(last_, part)) drop();
    if (!open_ && !begins(part)) return lose(part);
    if (!open_)
      open_ = part, pieces_ = 1;
    else
      open_->ranges.insert(open_->ranges.end(), part.ranges.begin(), part.ranges.end()), ++pieces_;
    last_ = part;
    if (width_of(*open_) > kWholeTurn - 0.5 * width_of(part)) close();
  }

  [[nodiscard]] std::vector<Scan> take() { return std::move(done_); }
  [[nodiscard]] const Discarded& lost() const { return lost_; }

 private:
  [[nodiscard]] bool begins(const Scan& part) const {
    return std::abs(math::wrap_angle(part.angle_min - start_)) < 0.5 * width_of(part);
  }

  void lose(const Scan& part) { count_one(lost_, part.t); }

  void drop() {
    lost_.count += pieces_ - 1;
    lose(*open_);
    open_.reset();
  }

  void close() {
    Scan& turn = *open_;
    turn.intensities.clear();
    if (!turn.time_increment)
      turn.time_increment =
          interval_ * static_cast<double>(pieces_) / static_cast<double>(turn.ranges.size());
    done_.push_back(std::move(turn));
    open_.reset();
  }

  double start_, interval_;
  std::optional<Scan> open_;
  std::size_t pieces_ = 0;
  Scan last_;
  std::vector<Scan> done_;
  Discarded lost_{"scan", "part of a turn without its other parts"};
};

}  // namespace

std::optional<Recording> with_joined_turns(const Recording& recording) {
  const std::size_t parts = parts_of(recording.scans);
  if (parts < 2) return std::nullopt;
  Turns turns(recording.scans);
  for (const Scan& part : recording.scans) turns.add(part);
  Recording joined = recording;
  joined.scans = turns.take();
  if (Discarded lost = turns.lost(); lost.count > 0) {
    lost.of = recording.scans.size();
    joined.discarded.push_back(lost);
  }
  joined.repairs.push_back({"turns", "joined from " + std::to_string(parts) + " parts each",
                            "a turn comes in " + std::to_string(parts) + " messages: angle_min steps by " +
                                math::significant(360.0 / static_cast<double>(parts), 3) +
                                " degrees from one to the next"});
  return joined;
}

}  // namespace odomcalib::calib::ingest
