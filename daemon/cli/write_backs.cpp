#include "daemon/cli/write_backs.hpp"

#include <pwd.h>

#include <nlohmann/json.hpp>

namespace odomcalib::cli {

using nlohmann::ordered_json;

void name_users(ordered_json& entries) {
  for (auto& entry : entries) {
    if (!entry.is_object() || !entry.contains("user") || !entry["user"].is_number_unsigned()) continue;
    const passwd* const user = getpwuid(entry["user"].get<uid_t>());
    if (user != nullptr) entry["user_name"] = user->pw_name;
  }
}

}  // namespace odomcalib::cli
