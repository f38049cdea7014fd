#include "calib/report/explain.hpp"

#include "calib/estimation/first_look.hpp"
#include "calib/report/settings.hpp"

namespace odomcalib::calib::report {
namespace {

double share_that_contradicts(const Calibration& calibration) {
  for (const MethodResult& method : calibration.methods)
    if (method.name == "joint" && method.used + method.discarded > 0)
      return static_cast<double>(method.discarded) / static_cast<double>(method.used + method.discarded);
  return 0.0;
}

}  // namespace

bool needs_explanation(const Calibration& calibration) {
  return calibration.verdict == Verdict::refused ||
         share_that_contradicts(calibration) > settings::kManyContradict;
}

void explain(std::span<const Recording> recordings, Calibration& calibration) {
  if (!needs_explanation(calibration)) return;
  for (const Recording& recording : recordings)
    if (const auto cause = estimation::first_look(recording))
      return refuse_for({ErrorCode::refused, cause->what, recording.name, cause->remedy}, calibration);
}

void refuse_for(const Error& cause, Calibration& calibration) {
  Calibration refused;
  refused.robot = calibration.robot;
  refused.verdict = Verdict::refused;
  refused.reasons = {cause.text()};
  refused.data = std::move(calibration.data);
  refused.methods = std::move(calibration.methods);
  calibration = std::move(refused);
}

}  // namespace odomcalib::calib::report
