#include "daemon/service/solver_job.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "daemon/service/json_text.hpp"
#include "daemon/service/settings.hpp"
#include "daemon/service/state_folder.hpp"
#include "proto/control/control.hpp"

namespace odomcalib {

// Shared with the thread, which may outlive the job when the daemon ends.
struct SolverJob::State {
  mutable std::mutex mutex;
  std::string phase = "reading";
  double fraction = 0.0;
  std::optional<Result<Solution>> result;
  std::optional<Error> not_kept;

  void report(const std::string& name, double share) {
    const std::lock_guard lock(mutex);
    phase = name;
    fraction = share;
  }
  void finish(Result<Solution> solution, std::optional<Error> problem) {
    const std::lock_guard lock(mutex);
    not_kept = std::move(problem);
    result.emplace(std::move(solution));
  }
};

namespace {

using nlohmann::ordered_json;

std::string reply_with(const Calibrator& calibrator, const Calibration& calibration, const std::string& text,
                       const std::filesystem::path& recording) {
  ordered_json report = {{"recording", recording.string()}, {"calibration", ordered_json::parse(text)}};
  const auto next = calibrator.next_manoeuvre ? calibrator.next_manoeuvre(calibration) : std::nullopt;
  if (next) report["next"] = {{"manoeuvre", next->name}, {"why", next->why}};
  return control::encode_reply(json_text({{"result", report}}));
}

std::string in_a_line(const Calibration& calibration, const std::filesystem::path& recording) {
  std::string line = recording.filename().string() + ": " + name_of(calibration.verdict);
  for (const auto& [name, quantity] : calibration.parameters)
    line += fmt::format(", {} {:.6g} ± {:.2g} {}", name, quantity.value, quantity.std, quantity.unit);
  for (const std::string& reason : calibration.reasons) line += "; " + reason;
  return line;
}

/// @param recording the one just driven
Solution solution_of(const Calibrator& calibrator, const Calibration& calibration,
                     const std::filesystem::path& recording) {
  Solution solution;
  solution.calibration = to_json(calibration);
  solution.reply = reply_with(calibrator, calibration, solution.calibration, recording);
  solution.line = in_a_line(calibration, recording);
  solution.paths = report_data_of(calibration).paths;
  return solution;
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

struct End {
  Result<Solution> solution;
  std::optional<Error> not_kept = {};
};

// Nothing may leave the thread as an exception, not even that there is no memory for the recording.
End solved(const Calibrator& calibrator, const std::vector<std::filesystem::path>& paths,
           const std::vector<std::string>& effects, const std::filesystem::path& keep,
           const Calibrator::Progress& progress) {
  try {
    const auto calibration = calibrator.solve(paths, effects, progress);
    if (!calibration) return {calibration.error()};
    return {solution_of(calibrator, calibration.value(), paths.back()), keep_copy(calibration.value(), keep)};
  } catch (const std::exception& error) {
    return {Error{ErrorCode::format, error.what(), paths.front().string(), "report this recording"}};
  }
}

}  // namespace

SolverJob::SolverJob(const Calibrator& calibrator, std::vector<std::filesystem::path> recordings,
                     std::vector<std::string> effects, std::filesystem::path keep)
    : state_(std::make_shared<State>()) {
  std::thread([calibrator, paths = std::move(recordings), effects = std::move(effects),
               keep = std::move(keep), state = state_] {
    (void)setpriority(PRIO_PROCESS, 0, service::settings::kLessUrgent);  // of this thread alone
    const auto progress = [&state](const std::string& phase, double share) { state->report(phase, share); };
    auto end = solved(calibrator, paths, effects, keep, progress);
    state->finish(std::move(end.solution), std::move(end.not_kept));
  }).detach();
}

SolverJob::~SolverJob() = default;

std::pair<std::string, double> SolverJob::progress() const {
  // The solver's thread may be put aside while it has the lock: the loop does not wait for it.
  const std::unique_lock lock(state_->mutex, std::try_to_lock);
  if (lock) shown_ = {state_->phase, state_->fraction};
  return shown_;
}

std::optional<Error> SolverJob::not_kept() const {
  const std::lock_guard lock(state_->mutex);
  return state_->not_kept;
}

std::optional<Result<Solution>> SolverJob::take_result() {
  const std::unique_lock lock(state_->mutex, std::try_to_lock);
  return lock ? std::exchange(state_->result, std::nullopt) : std::nullopt;
}

}  // namespace odomcalib
