#include "calib/ingest/gaps.hpp"

#include "calib/ingest/settings.hpp"

namespace odomcalib::calib::ingest {

bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to) {
  for (std::size_t k = from; k < to; ++k)
    if (times[k + 1] - times[k] > settings::kMaxGap_s) return true;
  return false;
}

}  // namespace odomcalib::calib::ingest
