#include "daemon/service/solver_job.hpp"

#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "daemon/service/retention.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {

// Shared with the thread, which may outlive the job when the daemon ends.
struct SolverJob::State {
  mutable std::mutex mutex;
  std::string phase = "reading";
  double fraction = 0.0;
  std::optional<Result<Calibration>> result;
  std::optional<Error> not_kept;
  std::string text;

  void report(const std::string& name, double share) {
    const std::lock_guard lock(mutex);
    phase = name;
    fraction = share;
  }
  void finish(Result<Calibration> calibration, std::optional<Error> problem, std::string json) {
    const std::lock_guard lock(mutex);
    not_kept = std::move(problem);
    text = std::move(json);
    result.emplace(std::move(calibration));
  }
};

namespace {

// Nothing may leave the thread as an exception, not even that there is no memory for the recording.
Result<Calibration> solve(const Calibrator& calibrator, const std::vector<std::filesystem::path>& paths,
                          const std::vector<std::string>& effects, const Calibrator::Progress& progress) {
  try {
    return calibrator.solve(paths, effects, progress);
  } catch (const std::exception& error) {
    return Error{ErrorCode::format, error.what(), paths.front().string(), "report this recording"};
  }
}

std::optional<Error> keep_copy(const Calibration& calibration, const std::filesystem::path& file) {
  if (file.empty()) return std::nullopt;
  std::error_code ignored;  // shows in the writing
  std::filesystem::create_directories(file.parent_path(), ignored);
  const auto written = write_calibration(calibration, file);
  (void)keep_newest(file.parent_path(),
                    {std::numeric_limits<std::uintmax_t>::max(), service::settings::kMostCalibrations});
  return written ? std::nullopt : std::optional(written.error());
}

}  // namespace

SolverJob::SolverJob(const Calibrator& calibrator, std::vector<std::filesystem::path> recordings,
                     std::vector<std::string> effects, std::filesystem::path keep)
    : state_(std::make_shared<State>()) {
  std::thread([calibrator, paths = std::move(recordings), effects = std::move(effects),
               keep = std::move(keep), state = state_] {
    const auto progress = [&state](const std::string& phase, double share) { state->report(phase, share); };
    auto result = solve(calibrator, paths, effects, progress);
    auto problem = result ? keep_copy(result.value(), keep) : std::nullopt;
    auto text = result ? to_json(result.value()) : std::string();
    state->finish(std::move(result), std::move(problem), std::move(text));
  }).detach();
}

SolverJob::~SolverJob() = default;

std::pair<std::string, double> SolverJob::progress() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->phase, state_->fraction};
}

std::optional<Error> SolverJob::not_kept() const {
  const std::lock_guard lock(state_->mutex);
  return state_->not_kept;
}

std::string SolverJob::text() const {
  const std::lock_guard lock(state_->mutex);
  return state_->text;
}

std::optional<Result<Calibration>> SolverJob::take_result() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->result, std::nullopt);
}

}  // namespace odomcalib
