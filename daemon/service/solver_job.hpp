// Waiting for a solver in a thread of its own, so that the loop never does.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/calibrator.hpp"
#include "daemon/service/solution.hpp"

namespace odomcalib {

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
};

}  // namespace odomcalib
