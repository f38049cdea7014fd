#include "daemon/service/cancellable.hpp"

#include <stdexcept>
#include <utility>

namespace odomcalib {

Calibrator cancellable(Calibrator calibrator, CancelFlag cancelled) {
  if (!calibrator.solve) return calibrator;
  calibrator.solve = [solve = std::move(calibrator.solve), cancelled = std::move(cancelled)](
                         const std::vector<std::filesystem::path>& recordings,
                         const std::vector<std::string>& effects, const Calibrator::Progress& progress) {
    const auto report = [&](const std::string& phase, double fraction) {
      if (*cancelled) throw std::runtime_error("stopped on request");
      if (progress) progress(phase, fraction);
    };
    return solve(recordings, effects, report);
  };
  return calibrator;
}

}  // namespace odomcalib
