#include "drivers/lidar/rplidar/guess.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/lidar/rplidar/settings.hpp"

namespace odomcalib::drivers::rplidar {
namespace {

using Kind = Guess::Kind;

std::size_t size_of(PacketType type) { return find_format(static_cast<unsigned>(type))->bytes; }

/// Sound packets in a row at the front, not more than `most`.
std::size_t run_of(PacketType type, Bytes rest, std::size_t most) {
  const std::size_t size = size_of(type);
  std::size_t n = 0;
  while (n < most && rest.size() >= size && is_intact(type, rest.first(size))) {
    rest = rest.subspan(size);
    ++n;
  }
  return n;
}

/// Whether at least `wanted` packets of a type begin here.
Guess run_begins(PacketType type, Bytes rest, std::size_t wanted) {
  const std::size_t n = run_of(type, rest, wanted);
  if (n == wanted) return {Kind::found, type};
  const Bytes behind = rest.subspan(n * size_of(type));
  const bool cut = behind.size() < size_of(type) && may_begin(type, behind);
  return {cut ? Kind::wait : Kind::none, type};
}

/// Neighbouring beams with readings, and those among them that see about the same distance.
struct Pairs {
  unsigned all = 0, smooth = 0;
  [[nodiscard]] double share() const { return all > 0 ? static_cast<double>(smooth) / all : 0.0; }
};

Pairs pairs_in(PacketType type, Bytes capsules) {
  Pairs pairs;
  for (; capsules.size() >= size_of(type); capsules = capsules.subspan(size_of(type))) {
    const Bytes capsule = capsules.first(size_of(type));
    const auto points = capsule_points(type, capsule, capsule, 0.0);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double a = points[i - 1].range_mm, b = points[i].range_mm;
      if (a <= 0.0 || b <= 0.0) continue;
      ++pairs.all;
      if (std::abs(a - b) < kSmoothPart * std::min(a, b) + kSmooth_mm) ++pairs.smooth;
    }
  }
  return pairs;
}

bool clearly(const Pairs& one, const Pairs& other) {
  return one.all >= kFewestPairs && one.share() > kSmooth && other.share() < kRough * one.share();
}

/// Express and dense capsules have one length and one checksum.
Guess layout_of(Bytes rest) {
  const std::size_t size = size_of(PacketType::express);
  const std::size_t n = run_of(PacketType::express, rest, kMostCapsules);
  const Bytes capsules = rest.first(n * size);
  const Pairs express = pairs_in(PacketType::express, capsules);
  const Pairs dense = pairs_in(PacketType::dense, capsules);
  if (clearly(express, dense)) return {Kind::found, PacketType::express};
  if (clearly(dense, express)) return {Kind::found, PacketType::dense};
  return {n == kMostCapsules || rest.size() >= (n + 1) * size ? Kind::ambiguous : Kind::wait,
          PacketType::express};
}

}  // namespace

Guess guess_type(Bytes rest, std::optional<PacketType> given) {
  bool undecided = false;
  const auto begins = [&](PacketType type, std::size_t wanted) {
    const Guess guess = run_begins(type, rest, wanted);
    undecided |= guess.kind == Kind::wait;
    return guess.kind == Kind::found;
  };
  if (begins(PacketType::express, kCapsuleRun)) return given ? Guess{Kind::found, *given} : layout_of(rest);
  for (const PacketType type : {PacketType::ultra, PacketType::ultra_dense})
    if (begins(type, kCapsuleRun)) return {Kind::found, type};
  if (begins(PacketType::hq, 1)) return {Kind::found, PacketType::hq};
  if (undecided) return {Kind::wait};
  return run_begins(PacketType::standard, rest, kStandardRun);
}

}  // namespace odomcalib::drivers::rplidar
