#include "calib/selection/search_result.hpp"

#include <algorithm>

#include "calib/selection/candidate.hpp"

namespace odomcalib::calib::selection {

bool SearchResult::has_unnamed() const {
  return std::any_of(smooths.begin(), smooths.end(),
                     [](const AddedSmoothTerm& c) { return c.named_term == nullptr; });
}

std::shared_ptr<const vehicle::Effect> SearchResult::owner_of(const vehicle::Dependence& dependence) const {
  for (const Finding& finding : findings)
    if (contains(finding.effect->dependences(), dependence)) return finding.effect;
  return nullptr;
}

bool SearchResult::is_completed(const std::shared_ptr<const vehicle::Effect>& name) const {
  return std::any_of(smooths.begin(), smooths.end(),
                     [&](const AddedSmoothTerm& c) { return c.named_term == name; });
}

void SearchResult::forget(const std::shared_ptr<const vehicle::Effect>& effect) {
  const auto completes = [&](const AddedSmoothTerm& c) { return c.named_term == effect; };
  const auto finding =
      std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.effect == effect; });
  const auto heir = std::find_if(smooths.begin(), smooths.end(), completes);
  if (finding != findings.end() && heir != smooths.end())
    heir->validation.before = finding->validation.before;
  for (AddedSmoothTerm& smooth : smooths)
    if (completes(smooth)) smooth.named_term = nullptr;
  if (finding != findings.end()) findings.erase(finding);
  std::erase_if(smooths, [&](const AddedSmoothTerm& c) { return c.effect == effect; });
  std::erase(nuisance, effect);
}

}  // namespace odomcalib::calib::selection
