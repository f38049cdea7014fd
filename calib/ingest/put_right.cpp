#include "calib/ingest/put_right.hpp"

#include <array>
#include <utility>
#include <vector>

#include "calib/ingest/reference_faults.hpp"

namespace odomcalib::calib::ingest {
namespace {

/// Each sees the recording as those before left it: parts of turns belong to one lidar, and whole turns
/// repeat.
using Mend = std::optional<Recording> (*)(const Recording&);
constexpr std::array kMends = {Mend{without_dead_counts},    Mend{with_joined_turns},
                               Mend{without_repeated_scans}, Mend{without_repeated_poses},
                               Mend{with_whole_turns},       Mend{with_unused_scans_told}};

void mend(Repairs& repairs, std::size_t i, const Recording& given, const std::string& sensor) {
  std::optional<Recording> mended = of_one_sensor(given, sensor);
  for (const Mend one : kMends)
    if (auto next = one(mended ? *mended : given)) mended = std::move(next);
  if (mended) repairs.own(i) = std::move(*mended);
}

}  // namespace

Recordings put_right(std::span<const Recording> given, const std::string& sensor) {
  Repairs repairs(given);
  for (std::size_t i = 0; i < given.size(); ++i) mend(repairs, i, given[i], sensor);
  return std::move(repairs).take();
}

}  // namespace odomcalib::calib::ingest
