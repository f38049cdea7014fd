#include "calib/validation/folds.hpp"

namespace odomcalib::calib {

std::vector<std::size_t> folds_of(std::span<const FitData> data) {
  constexpr double kBlockSeconds = 20.0;
  std::vector<std::size_t> folds;
  std::size_t block = 0;
  for (const FitData& d : data) {
    double begin = -1e300;
    for (const SensorPair& pair : d.pairs) {
      if (pair.interval.begin > begin + kBlockSeconds) {
        begin = pair.interval.begin;
        ++block;
      }
      folds.push_back(block % kFolds);
    }
  }
  return folds;
}

}  // namespace odomcalib::calib
