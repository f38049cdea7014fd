#include "calib/report/gate.hpp"

#include <utility>

#include "calib/estimation/first_look.hpp"
#include "calib/report/settings.hpp"
#include "calib/report/verdict_rules.hpp"

namespace odomcalib::calib::report {
namespace {

double share_that_contradicts(const Calibration& calibration) {
  for (const MethodResult& method : calibration.methods)
    if (method.name == "joint" && method.used + method.discarded > 0)
      return static_cast<double>(method.discarded) / static_cast<double>(method.used + method.discarded);
  return 0.0;
}

/// Whether a mistake in the recordings is likelier than a bad drive.
bool needs_explanation(const Calibration& calibration) {
  return calibration.verdict == Verdict::refused ||
         share_that_contradicts(calibration) > settings::kManyContradict;
}

/// Refused for this reason; keeps what was measured, but no value of a fit.
Calibration refused_for(const Error& cause, Calibration calibration) {
  Calibration refused;
  refused.robot = calibration.robot;
  refused.verdict = Verdict::refused;
  refused.reasons = {cause.text()};
  refused.next_step = next_after(cause);
  refused.driven = calibration.driven;
  refused.data = std::move(calibration.data);
  refused.discarded = std::move(calibration.discarded);
  refused.repairs = std::move(calibration.repairs);
  refused.methods = std::move(calibration.methods);
  return refused;
}

}  // namespace

std::string next_after(const Error& error) {
  return error.remedy.empty() ? "record again" : error.remedy + "; then solve again";
}

GateResult judge(const Calibration& calibration, const VerdictEvidence& evidence) {
  GateResult refused{Verdict::refused, {}}, warned{Verdict::accepted_with_warnings, {}};
  for (const VerdictRule& rule : verdict_rules())
    for (const Objection& objection : rule.objections(calibration, evidence)) {
      if (objection.is_said) continue;
      GateResult& result = objection.refuses ? refused : warned;
      result.reasons.push_back(objection.reason);
      if (result.next_step.empty()) result.next_step = objection.next.empty() ? rule.next : objection.next;
    }
  if (!refused.reasons.empty()) return refused;
  return warned.reasons.empty() ? GateResult{Verdict::accepted, {}} : warned;
}

Calibration explained(std::span<const Recording> recordings, Calibration calibration) {
  if (!needs_explanation(calibration)) return calibration;
  for (const Recording& recording : recordings)
    if (const auto mistake = estimation::first_look(recording))
      return refused_for(*mistake, std::move(calibration));
  return calibration;
}

}  // namespace odomcalib::calib::report
