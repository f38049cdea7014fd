#include "daemon/writeback/way_back.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/writeback/settings.hpp"

namespace odomcalib {
namespace {

double step_of(const std::vector<drivers::StoredParameter>& steps, const std::string& quantity) {
  const auto found =
      std::find_if(steps.begin(), steps.end(), [&](const auto& one) { return one.quantity == quantity; });
  return found == steps.end() ? 0.0 : found->step;
}

}  // namespace

WayBack::WayBack(const std::vector<HistoryEntry>& entries, const std::string& device) {
  for (const HistoryEntry& entry : entries) {
    const bool own = device.empty() || entry.device.empty() || entry.device == device;
    if (own && entry.outcome == "committed") own_.push_back(&entry);
  }
}

const HistoryEntry* WayBack::older_than(const std::string& id) const {
  const auto found = std::find_if(own_.begin(), own_.end(), [&](const auto* one) { return one->id < id; });
  return found == own_.end() ? nullptr : *found;
}

// A rollback has brought back what was in force before the entry that it names: the next one goes before the
// entry before that.
const HistoryEntry* WayBack::next() const {
  const HistoryEntry* entry = newest();
  while (entry != nullptr && !entry->origin.restores.empty()) entry = older_than(entry->origin.restores);
  return entry;
}

const HistoryEntry* WayBack::following(const HistoryEntry& entry) const {
  const auto older =
      std::find_if(own_.begin(), own_.end(), [&](const auto* one) { return one->id <= entry.id; });
  return older == own_.begin() ? nullptr : *std::prev(older);
}

WayBack::Values WayBack::after(const HistoryEntry& entry) const {
  Values values;
  for (auto one = own_.rbegin(); one != own_.rend() && (*one)->id <= entry.id; ++one)
    for (const auto& [name, value] : (*one)->after) values[name] = value;
  return values;
}

WayBack::Values WayBack::before(const HistoryEntry& entry) const {
  const HistoryEntry* older = older_than(entry.id);
  Values values = older != nullptr ? after(*older) : Values();
  for (const auto& [name, value] : entry.before) values[name] = value;
  return values;
}

const HistoryEntry* WayBack::verified(const Values& values,
                                      const std::vector<drivers::StoredParameter>& steps) const {
  for (const HistoryEntry* entry : own_) {
    const Values held = after(*entry);
    const auto same = [&](const auto& wanted) {
      const auto found = held.find(wanted.first);
      return found != held.end() &&
             std::abs(found->second - wanted.second) <=
                 writeback::settings::kSameStep * step_of(steps, wanted.first) + writeback::settings::kSame_m;
    };
    if (!values.empty() && std::all_of(values.begin(), values.end(), same)) return entry;
  }
  return nullptr;
}

}  // namespace odomcalib
