// A line that doubles frames, lets them come late and out of order, and loses some: by chance, with a seed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "tests/sim/wires/frame.hpp"

namespace odomcalib::sim {

/// Shares of the frames, in [0, 1]. A frame that is doubled is two, and what happens to each is its own
/// chance.
struct LineFaults {
  double doubled = 0.0, dropped = 0.0, late = 0.0;
  double latest = 0.0;                                 ///< s that a late one takes longer, at most
  std::function<bool(const Frame&)> may_be_late = {};  ///< empty: every frame
};

class FrameLine {
 public:
  FrameLine(LineFaults faults, std::uint64_t seed) : faults_(std::move(faults)), random_(seed) {}

  void send(const Frame& frame, double now) {
    put(frame, now);
    if (happens(faults_.doubled)) put(frame, now);
  }
  /// Frames that have come to the other end by now.
  std::vector<Frame> take(double now) {
    std::vector<Frame> out;
    const auto first_waiting = std::stable_partition(waiting_.begin(), waiting_.end(),
                                                     [&](const auto& one) { return one.first <= now; });
    std::stable_sort(waiting_.begin(), first_waiting,
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto one = waiting_.begin(); one != first_waiting; ++one) out.push_back(one->second);
    waiting_.erase(waiting_.begin(), first_waiting);
    return out;
  }

 private:
  bool happens(double share) { return share > 0.0 && chance() < share; }
  double chance() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  void put(const Frame& frame, double now) {
    if (happens(faults_.dropped)) return;
    const bool late = happens(faults_.late) && (!faults_.may_be_late || faults_.may_be_late(frame));
    waiting_.emplace_back(now + (late ? faults_.latest * chance() : 0.0), frame);
  }

  LineFaults faults_;
  std::mt19937_64 random_;
  std::vector<std::pair<double, Frame>> waiting_;  // s when it arrives
};

}  // namespace odomcalib::sim
