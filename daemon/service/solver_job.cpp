#include "daemon/service/solver_job.hpp"

#include <exception>
#include <mutex>
#include <thread>

namespace odomcalib {

// Shared with the thread, which may outlive the job when the daemon ends.
struct SolverJob::State {
  mutable std::mutex mutex;
  std::string phase = "reading";
  double fraction = 0.0;
  std::optional<Result<Calibration>> result;

  void report(const std::string& name, double share) {
    const std::lock_guard lock(mutex);
    phase = name;
    fraction = share;
  }
  void finish(Result<Calibration> calibration) {
    const std::lock_guard lock(mutex);
    result.emplace(std::move(calibration));
  }
};

namespace {

Result<Calibration> solve(const Calibrator& calibrator, const std::vector<std::filesystem::path>& paths,
                          const std::vector<std::string>& effects, const Calibrator::Progress& progress) {
  std::vector<Recording> recordings;
  for (const auto& path : paths) {
    auto recording = read_recording(path);
    if (!recording) return recording.error();
    recordings.push_back(std::move(recording).value());
  }
  try {
    return calibrator.solve(recordings, effects, progress);
  } catch (const std::exception& error) {
    return Error{ErrorCode::format, error.what(), paths.front().string(), "report this recording"};
  }
}

}  // namespace

SolverJob::SolverJob(const Calibrator& calibrator, std::vector<std::filesystem::path> recordings,
                     std::vector<std::string> effects, std::filesystem::path keep)
    : state_(std::make_shared<State>()) {
  std::thread([calibrator, paths = std::move(recordings), effects = std::move(effects),
               keep = std::move(keep), state = state_] {
    const auto progress = [&state](const std::string& phase, double share) { state->report(phase, share); };
    auto result = solve(calibrator, paths, effects, progress);
    if (result && !keep.empty()) (void)write_calibration(result.value(), keep);
    state->finish(std::move(result));
  }).detach();
}

SolverJob::~SolverJob() = default;

std::pair<std::string, double> SolverJob::progress() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->phase, state_->fraction};
}

std::optional<Result<Calibration>> SolverJob::take_result() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->result, std::nullopt);
}

}  // namespace odomcalib
