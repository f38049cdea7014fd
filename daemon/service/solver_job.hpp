// Waiting for a solver in a thread of its own, so that the loop never does.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/calibrator.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib {

/// Parts of a calibration that the loop sends on. The solver's thread makes them: on a small computer it
/// takes longer than the drive waits for a sign of life.
struct Solution {
  std::string calibration;       ///< JSON text, as in a file
  std::string reply;             ///< frame for the caller
  std::string line;              ///< for the journal
  std::vector<PathTrace> paths;  ///< of the drive, for viewers
};

class SolverJob {
 public:
  struct State;
  /// @param recordings of one robot, solved jointly
  /// @param keep file for a copy of the result, in a folder that is made where needed; empty: none
  SolverJob(const Calibrator& calibrator, std::vector<std::filesystem::path> recordings,
            std::vector<std::string> effects, std::filesystem::path keep = {});
  ~SolverJob();
  SolverJob(const SolverJob&) = delete;
  SolverJob& operator=(const SolverJob&) = delete;

  [[nodiscard]] std::pair<std::string, double> progress() const;
  /// Why there is no copy of the result, when that failed.
  [[nodiscard]] std::optional<Error> not_kept() const;
  /// Once, when it is there.
  std::optional<Result<Solution>> take_result();

 private:
  std::shared_ptr<State> state_;
  mutable std::pair<std::string, double> shown_{"reading", 0.0};
};

}  // namespace odomcalib
