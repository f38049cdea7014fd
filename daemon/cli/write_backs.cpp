#include "daemon/cli/write_backs.hpp"

#include <fmt/format.h>
#include <pwd.h>

#include <algorithm>
#include <optional>
#include <set>
#include <system_error>

#include "daemon/cli/client.hpp"
#include "daemon/cli/settings.hpp"
#include "daemon/config/config.hpp"
#include "daemon/writeback/calibration_in_force.hpp"
#include "daemon/writeback/history.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kRemedy =
    "name what odomcalibctl history --json printed, or the state folder of odomcalibd";

/// An entry without members that this program does not know; nullopt: it is none.
std::optional<ordered_json> checked(const ordered_json& body) {
  const auto entry = history_entry_from(body);
  if (!entry) return std::nullopt;
  auto out = ordered_json::parse(to_json(*entry, false), nullptr, false);
  if (body.contains("user_name") && body["user_name"].is_string()) out["user_name"] = body["user_name"];
  return out;
}

Result<ordered_json> entries_in(const ordered_json& document, const std::string& where) {
  if (!document.is_object() || !document.contains("entries") || !document["entries"].is_array())
    return Error{ErrorCode::format, "is no history of write-backs", where, kRemedy};
  ordered_json entries = ordered_json::array();
  for (const auto& body : document["entries"]) {
    auto entry = checked(body);
    if (!entry)
      return Error{ErrorCode::format, fmt::format("\"entries[{}]\" is no write-back", entries.size()), where,
                   kRemedy};
    entries.push_back(std::move(*entry));
  }
  return entries;
}

Result<ordered_json> entries_of_folder(const fs::path& state_folder) {
  const fs::path folder = state_folder / "history";
  std::error_code error;
  const fs::directory_iterator readable(folder, error);
  if (error)
    return Error{ErrorCode::io, "cannot read the history: " + error.message(), folder.string(), kRemedy};
  ordered_json entries = ordered_json::array();
  const History history(folder);
  for (const HistoryEntry& entry : history.entries())
    entries.push_back(ordered_json::parse(to_json(entry, false), nullptr, false));
  return entries;
}

Result<ordered_json> entries_of_service(const std::string& socket) {
  auto client = Client::connect(socket);
  if (!client) return client.error();
  const auto answer = client.value().call("History", ordered_json::object(), settings::kAnswerWithin_ms);
  if (!answer) return answer.error();
  return entries_in(ordered_json::parse(answer.value(), nullptr, false), socket);
}

/// Names that are not known are of no robot.
bool is_same(const std::string& a, const std::string& b) { return !a.empty() && a == b; }

}  // namespace

void name_users(ordered_json& entries) {
  for (auto& entry : entries) {
    if (!entry.is_object() || !entry.contains("user") || !entry["user"].is_number_unsigned()) continue;
    const passwd* const user = getpwuid(entry["user"].get<uid_t>());
    if (user != nullptr) entry["user_name"] = user->pw_name;
  }
}

Result<ordered_json> read_history(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return entries_of_folder(path);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  return entries_in(ordered_json::parse(bytes.value(), nullptr, false), path.string());
}

ordered_json history_of_this_machine(const std::string& socket) {
  auto entries = entries_of_service(socket);
  if (!entries) entries = entries_of_folder(Config().state_dir);
  if (!entries) return ordered_json::array();
  name_users(entries.value());
  return std::move(entries).value();
}

std::string digest_in_history(const Calibration& calibration) {
  return sha256_hex(text_in_force(calibration));
}

ordered_json entries_of_robot(const ordered_json& entries, const Calibration& calibration) {
  const std::string digest = digest_in_history(calibration), robot = calibration.robot.robot_id;
  const auto is_its_own = [&](const ordered_json& entry) {
    return entry.value("calibration_sha256", "") == digest || is_same(entry.value("robot_id", ""), robot);
  };
  std::set<std::string> controllers = {calibration.robot.controller_id};
  for (const auto& entry : entries)
    if (is_its_own(entry)) controllers.insert(entry.value("device", ""));
  controllers.erase("");
  const auto is_of_another = [&](const ordered_json& entry) {
    const std::string named = entry.value("robot_id", "");
    return !named.empty() && !robot.empty() && named != robot;
  };
  ordered_json own = ordered_json::array();
  for (const auto& entry : entries)
    if (is_its_own(entry) || (controllers.contains(entry.value("device", "")) && !is_of_another(entry)))
      own.push_back(entry);
  return own;
}

}  // namespace odomcalib::cli
