#include "daemon/writeback/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <system_error>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::ordered_json;

/// Its name is its id, whatever is in it.
std::optional<HistoryEntry> entry_from(const std::filesystem::path& path) {
  const auto bytes = read_file_bytes(path);
  if (!bytes) return std::nullopt;
  auto body = ordered_json::parse(bytes.value(), nullptr, false);
  if (body.is_object()) body["id"] = path.stem().string();
  return history_entry_from(body);
}

unsigned number_of(const std::string& id) {
  unsigned number = 0;
  std::from_chars(id.data(), id.data() + id.size(), number);
  return number;
}

unsigned number_of(const std::filesystem::path& path) { return number_of(path.stem().string()); }

}  // namespace

HistoryEntry entry_of(const JournalRecord& end) {
  HistoryEntry entry{.id = end.origin.entry,
                     .time = end.wall_us,
                     .action = end.label,
                     .outcome = "unknown",
                     .calibration = std::nullopt,
                     .before = end.before,
                     .after = end.after,
                     .device = end.device,
                     .origin = end.origin};
  if (end.state == JournalState::commit) entry.outcome = "committed";
  if (end.state == JournalState::rolled_back) entry.outcome = "rolled_back";
  return entry;
}

std::string to_json(const HistoryEntry& entry, bool with_calibration) {
  ordered_json body = {{"id", entry.id},           {"time", entry.time},     {"action", entry.action},
                       {"outcome", entry.outcome}, {"before", entry.before}, {"after", entry.after},
                       {"device", entry.device}};
  write_provenance(entry.origin, body);
  body.erase("entry");  // its id
  if (with_calibration && entry.calibration)
    body["calibration"] = ordered_json::parse(*entry.calibration, nullptr, false);
  return body.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::optional<HistoryEntry> history_entry_from(const ordered_json& body) {
  try {
    HistoryEntry entry;
    entry.id = body.at("id").get<std::string>();
    entry.time = body.at("time").get<std::int64_t>();
    entry.action = body.at("action").get<std::string>();
    entry.outcome = body.at("outcome").get<std::string>();
    entry.before = body.at("before").get<std::map<std::string, double>>();
    entry.after = body.at("after").get<std::map<std::string, double>>();
    entry.device = body.value("device", "");
    entry.origin = read_provenance(body);
    if (body.contains("calibration") && body["calibration"].is_object())
      entry.calibration = body["calibration"].dump();
    return entry;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  }
}

History::Listing History::listing() const {
  Listing all;
  std::vector<std::filesystem::path>& found = all.files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".json") found.push_back(it->path());
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return number_of(a) > number_of(b); });
  if (error && error != std::errc::no_such_file_or_directory)
    all.error = Error{ErrorCode::io, "cannot read the history: " + error.message(), folder_.string(),
                      "check this folder and its file system; a running daemon looks at it again by itself"};
  return all;
}

History::History(std::filesystem::path folder) : folder_(std::move(folder)) {
  Listing all = listing();
  unlisted_ = std::move(all.error);
  for (const auto& path : all.files) {
    newest_ = std::max(newest_, number_of(path));
    if (auto entry = entry_from(path))
      entries_.push_back(std::move(*entry));
    else
      unreadable_.push_back(path);
  }
}

HistoryEntry History::numbered(HistoryEntry entry) const {
  entry.id = fmt::format("{:04}", newest_ + 1);
  return entry;
}

Result<void> History::write(const HistoryEntry& entry) const {
  if (unlisted_) return *unlisted_;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (auto written = replace_file(folder_ / (entry.id + ".json"), to_json(entry, true)); !written)
    return written;
  const auto present = listing().files;
  for (std::size_t i = kKept; i < present.size(); ++i) std::filesystem::remove(present[i], error);
  return {};
}

void History::keep(HistoryEntry entry) {
  newest_ = std::max(newest_, number_of(entry.id));
  std::erase_if(unreadable_, [&](const std::filesystem::path& one) { return one.stem() == entry.id; });
  std::erase_if(entries_, [&](const HistoryEntry& one) { return one.id == entry.id; });
  const auto older = std::find_if(entries_.begin(), entries_.end(), [&](const HistoryEntry& one) {
    return number_of(one.id) < number_of(entry.id);
  });
  entries_.insert(older, std::move(entry));
  if (entries_.size() > kKept) entries_.resize(kKept);
}

bool History::knows(const HistoryEntry& entry) const {
  const auto known = find(entry.id);
  return known && known->outcome == entry.outcome;
}

void History::take_over(History found) {
  for (HistoryEntry& entry : entries_)
    if (!found.knows(entry)) found.keep(std::move(entry));
  entries_ = std::move(found.entries_);
  unreadable_ = std::move(found.unreadable_);
  unlisted_ = std::move(found.unlisted_);
  newest_ = std::max(newest_, found.newest_);
}

// The id was given when the write-back began: a record of an earlier version has none, and had its entry
// written.
std::vector<JournalRecord> History::missing(const std::vector<JournalRecord>& ends) const {
  std::vector<JournalRecord> out;
  for (const JournalRecord& end : ends) {
    const bool kept = number_of(end.origin.entry) + kKept > newest_;
    std::erase_if(out, [&](const JournalRecord& one) { return one.origin.entry == end.origin.entry; });
    if (!end.origin.entry.empty() && kept && !knows(entry_of(end))) out.push_back(end);
  }
  return out;
}

std::optional<HistoryEntry> History::find(const std::string& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const HistoryEntry& entry) { return entry.id == id; });
  return found == entries_.end() ? std::nullopt : std::optional(*found);
}

std::optional<HistoryEntry> History::newest_committed() const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [](const HistoryEntry& entry) { return entry.outcome == "committed"; });
  return found == entries_.end() ? std::nullopt : std::optional(*found);
}

}  // namespace odomcalib
