#include "calib/report/gate.hpp"

#include "calib/report/verdict_rules.hpp"

namespace odomcalib::calib::report {

GateResult judge(const Calibration& calibration, const Footing& footing) {
  std::vector<std::string> refusals, warnings;
  for (const VerdictRule& rule : verdict_rules())
    for (const Objection& objection : rule.objections(calibration, footing))
      (objection.refuses ? refusals : warnings).push_back(objection.reason);
  if (!refusals.empty()) return {Verdict::refused, refusals};
  if (!warnings.empty()) return {Verdict::accepted_with_warnings, warnings};
  return {Verdict::accepted, {}};
}

}  // namespace odomcalib::calib::report
