#include "daemon/cli/write_backs.hpp"

#include <fmt/format.h>
#include <pwd.h>

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include "daemon/cli/client.hpp"
#include "daemon/cli/output.hpp"
#include "daemon/cli/settings.hpp"
#include "daemon/config/config.hpp"
#include "daemon/writeback/calibration_in_force.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kRemedy =
    "name what odomcalibctl history --json printed, or the state folder of odomcalibd";

Result<std::vector<WriteBack>> entries_in(const ordered_json& document, const std::string& where) {
  if (!document.is_object() || !document.contains("entries") || !document["entries"].is_array())
    return Error{ErrorCode::format, "is no history of write-backs", where, kRemedy};
  std::vector<WriteBack> entries;
  for (const auto& body : document["entries"]) {
    auto entry = write_back_from(body);
    if (!entry)
      return Error{ErrorCode::format, fmt::format("\"entries[{}]\" is no write-back", entries.size()), where,
                   kRemedy};
    entries.push_back(std::move(*entry));
  }
  return entries;
}

Result<std::vector<WriteBack>> entries_of_folder(const fs::path& state_folder) {
  const fs::path folder = state_folder / "history";
  std::error_code error;
  const fs::directory_iterator readable(folder, error);
  if (error)
    return Error{ErrorCode::io, "cannot read the history: " + error.message(), folder.string(), kRemedy};
  std::vector<WriteBack> entries;
  const History history(folder);
  if (history.unlisted()) return *history.unlisted();
  for (const HistoryEntry& entry : history.entries()) entries.push_back({entry, ""});
  for (const fs::path& path : history.unreadable())
    warn(path.string() + ": holds no write-back that can be read; left out");
  return entries;
}

Result<std::vector<WriteBack>> entries_of_service(const std::string& socket) {
  const auto answer = call_once(socket, "History", ordered_json::object(), settings::kAnswerWithin_ms);
  if (!answer) return answer.error();
  return entries_in(answer.value(), socket);
}

/// Empty: it has none on this machine.
std::string name_of_user(uid_t user) {
  const passwd* const known = getpwuid(user);
  return known != nullptr ? known->pw_name : "";
}

/// Names that are not known are of no robot.
bool is_same(const std::string& a, const std::string& b) { return !a.empty() && a == b; }

}  // namespace

std::optional<WriteBack> write_back_from(const ordered_json& body) {
  auto entry = history_entry_from(body);
  if (!entry) return std::nullopt;
  WriteBack write_back{std::move(*entry), ""};
  if (body.contains("user_name") && body["user_name"].is_string())
    write_back.user_name = body["user_name"].get<std::string>();
  return write_back;
}

void name_users(ordered_json& entries) {
  for (auto& entry : entries) {
    if (!entry.is_object() || !entry.contains("user") || !entry["user"].is_number_unsigned()) continue;
    if (std::string name = name_of_user(entry["user"].get<uid_t>()); !name.empty())
      entry["user_name"] = std::move(name);
  }
}

Result<std::vector<WriteBack>> read_history(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return entries_of_folder(path);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  return entries_in(ordered_json::parse(bytes.value(), nullptr, false), path.string());
}

std::vector<WriteBack> history_of_this_machine(const std::string& socket) {
  auto entries = entries_of_service(socket);
  if (!entries) entries = entries_of_folder(Config().state_dir);
  if (!entries) return {};
  for (WriteBack& one : entries.value())
    if (const auto& user = one.entry.origin.user) one.user_name = name_of_user(*user);
  return std::move(entries).value();
}

std::string digest_in_history(const Calibration& calibration) {
  return sha256_hex(text_in_force(calibration));
}

std::vector<WriteBack> entries_of_robot(const std::vector<WriteBack>& entries,
                                        const Calibration& calibration) {
  const std::string digest = digest_in_history(calibration), robot = calibration.robot.robot_id;
  const auto is_its_own = [&](const HistoryEntry& entry) {
    return entry.origin.calibration_sha256 == digest || is_same(entry.origin.robot_id, robot);
  };
  std::set<std::string> controllers = {calibration.robot.controller_id};
  for (const WriteBack& one : entries)
    if (is_its_own(one.entry)) controllers.insert(one.entry.device);
  controllers.erase("");
  const auto is_of_another = [&](const HistoryEntry& entry) {
    const std::string& named = entry.origin.robot_id;
    return !named.empty() && !robot.empty() && named != robot;
  };
  std::vector<WriteBack> own;
  for (const WriteBack& one : entries)
    if (is_its_own(one.entry) || (controllers.contains(one.entry.device) && !is_of_another(one.entry)))
      own.push_back(one);
  return own;
}

}  // namespace odomcalib::cli
