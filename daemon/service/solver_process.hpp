// Solving in a process of its own: what it takes of memory and processor, and how it may end, are not the
// service's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "daemon/service/calibrator.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {

struct SolverProcess {
  /// The service's own program, whichever file it was started from.
  std::filesystem::path program = "/proc/self/exe";
  std::uint32_t memory = service::settings::kSolverMemory_MiB;
};

/// A solver that starts `odomcalibd --solve` and tells what that tells. Each of its progress reports comes at
/// least every 0.1 s, the same one again where there is none; one that throws kills the process.
/// Error: what the solver says; io when it ended without an answer.
Calibrator::Solve solve_in_process(const SolverProcess& process);

/// Work of that process: limits itself, solves, and answers on descriptor 3 as on the control socket.
/// @return exit status
int answer_with_solution(const Calibrator::Solve& solve, const std::vector<std::filesystem::path>& recordings,
                         const std::vector<std::string>& effects, std::uint32_t memory);

}  // namespace odomcalib
