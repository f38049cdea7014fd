#include "calib/selection/search_result.hpp"

#include <algorithm>

#include "calib/selection/candidate.hpp"

namespace odomcalib::calib::selection {

bool SearchResult::has_unnamed() const {
  return std::any_of(curves.begin(), curves.end(), [](const AddedCurve& c) { return c.law_of == nullptr; });
}

std::shared_ptr<const vehicle::Effect> SearchResult::owner_of(const vehicle::Law& law) const {
  for (const Finding& finding : findings)
    if (contains(finding.effect->laws(), law)) return finding.effect;
  return nullptr;
}

bool SearchResult::is_completed(const std::shared_ptr<const vehicle::Effect>& name) const {
  return std::any_of(curves.begin(), curves.end(), [&](const AddedCurve& c) { return c.law_of == name; });
}

void SearchResult::forget(const std::shared_ptr<const vehicle::Effect>& effect) {
  const auto completes = [&](const AddedCurve& c) { return c.law_of == effect; };
  const auto finding =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.effect == effect; });
  const auto heir = std::find_if(curves.begin(), curves.end(), completes);
  if (finding != findings.end() && heir != curves.end()) heir->proof.before = finding->proof.before;
  for (AddedCurve& curve : curves)
    if (completes(curve)) curve.law_of = nullptr;
  if (finding != findings.end()) findings.erase(finding);
  std::erase_if(curves, [&](const AddedCurve& c) { return c.effect == effect; });
  std::erase(quiet, effect);
}

}  // namespace odomcalib::calib::selection
