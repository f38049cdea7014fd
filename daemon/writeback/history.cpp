#include "daemon/writeback/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::ordered_json;

std::optional<HistoryEntry> entry_from(const std::filesystem::path& path) {
  const auto bytes = read_file_bytes(path);
  if (!bytes) return std::nullopt;
  try {
    const auto body = ordered_json::parse(bytes.value());
    HistoryEntry entry;
    entry.id = path.stem().string();
    entry.time = body.at("time").get<std::int64_t>();
    entry.action = body.at("action").get<std::string>();
    entry.outcome = body.at("outcome").get<std::string>();
    entry.before = body.at("before").get<std::map<std::string, double>>();
    entry.after = body.at("after").get<std::map<std::string, double>>();
    entry.device = body.value("device", "");
    if (body.contains("calibration") && body["calibration"].is_object())
      entry.calibration = body["calibration"].dump();
    return entry;
  } catch (const ordered_json::exception&) {
    return std::nullopt;
  }
}

unsigned number_of(const std::filesystem::path& path) {
  unsigned number = 0;
  const std::string stem = path.stem().string();
  std::from_chars(stem.data(), stem.data() + stem.size(), number);
  return number;
}

}  // namespace

std::string to_json(const HistoryEntry& entry, bool with_calibration) {
  ordered_json body = {{"id", entry.id},           {"time", entry.time},     {"action", entry.action},
                       {"outcome", entry.outcome}, {"before", entry.before}, {"after", entry.after},
                       {"device", entry.device}};
  if (with_calibration && entry.calibration)
    body["calibration"] = ordered_json::parse(*entry.calibration, nullptr, false);
  return body.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::vector<std::filesystem::path> History::files() const {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".json") found.push_back(it->path());
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return number_of(a) > number_of(b); });
  return found;
}

Result<std::string> History::add(HistoryEntry entry) {
  const auto present = files();
  entry.id = fmt::format("{:04}", present.empty() ? 1 : number_of(present.front()) + 1);
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (auto written = replace_file(folder_ / (entry.id + ".json"), to_json(entry, true)); !written)
    return written.error();
  for (std::size_t i = kKept - 1; i < present.size(); ++i) std::filesystem::remove(present[i], error);
  return entry.id;
}

std::vector<HistoryEntry> History::entries() const {
  std::vector<HistoryEntry> all;
  for (const auto& path : files())
    if (auto entry = entry_from(path)) all.push_back(std::move(*entry));
  return all;
}

std::optional<HistoryEntry> History::find(const std::string& id) const {
  for (auto& entry : entries())
    if (entry.id == id) return entry;
  return std::nullopt;
}

std::optional<HistoryEntry> History::newest_committed() const {
  for (auto& entry : entries())
    if (entry.outcome == "committed") return entry;
  return std::nullopt;
}

}  // namespace odomcalib
