#include "daemon/cli/answers.hpp"

#include <utility>

namespace odomcalib::cli {

using nlohmann::ordered_json;

Result<ordered_json> answer_with(const std::string& answer, const std::string& method,
                                 const std::string& member) {
  auto body = ordered_json::parse(answer, nullptr, false);
  if (body.is_object() && (member.empty() || body.contains(member))) return body;
  return Error{
      ErrorCode::format, "the daemon's answer has no " + (member.empty() ? "members" : member), method,
      "odomcalibd and odomcalibctl are of different versions: install both again, and restart odomcalibd"};
}

bool stands_in_the_way(const ordered_json& check) {
  if (!check.is_object() || !check.contains("outcome")) return true;
  return check["outcome"] != "ok" && check["outcome"] != "warn";
}

}  // namespace odomcalib::cli
