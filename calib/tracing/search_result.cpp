#include "calib/tracing/search_result.hpp"

#include <algorithm>

#include "calib/tracing/candidate.hpp"

namespace odomcalib::calib {

bool SearchResult::has_unnamed() const {
  return std::any_of(curves.begin(), curves.end(), [](const AddedCurve& c) { return c.law_of == nullptr; });
}

std::shared_ptr<const Effect> SearchResult::owner_of(const Law& law) const {
  for (const Finding& finding : findings)
    if (contains(finding.effect->laws(), law)) return finding.effect;
  return nullptr;
}

bool SearchResult::is_completed(const std::shared_ptr<const Effect>& name) const {
  return std::any_of(curves.begin(), curves.end(), [&](const AddedCurve& c) { return c.law_of == name; });
}

void SearchResult::forget(const std::shared_ptr<const Effect>& effect) {
  std::erase_if(findings, [&](const Finding& f) { return f.effect == effect; });
  std::erase_if(curves, [&](const AddedCurve& c) { return c.effect == effect; });
}

}  // namespace odomcalib::calib
