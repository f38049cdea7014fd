#include "daemon/cli/motion_call.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pwd.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <utility>

#include "daemon/cli/answer_documents.hpp"
#include "daemon/cli/client.hpp"
#include "daemon/cli/output.hpp"
#include "proto/angles.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

/// Facts that a person should know before it moves.
struct Prospect {
  std::string drawing;        ///< the space that it requires (rule M10)
  std::string besides;        ///< what of it the lidar would not see
  bool first_motion = false;  ///< nothing has moved this robot before
};

bool moves(const std::string& method) {
  return method == "Straight" || method == "Spin" || method == "Calibrate" || method == "Check";
}

// Rule M11: somebody has looked at the robot. What a script was given for good, nobody has said for a robot
// that has never moved: where there is somebody to ask, that one is asked.
Result<void> ask(const Consent& given, const std::string& what, const Prospect& prospect) {
  const std::string& besides = prospect.besides;
  const bool somebody = isatty(STDIN_FILENO) == 1;
  if (given.dry_run) return {};
  if (given.yes && !(prospect.first_motion && somebody)) {
    if (!besides.empty()) tell("odomcalibctl: " + besides);
    if (prospect.first_motion)
      tell("This is the first motion of this robot: stay beside it, with an emergency stop at hand.");
    return {};
  }
  if (!somebody) return Error{ErrorCode::usage, "moving or writing needs consent", what, "add --yes"};
  std::cerr
      << prospect.drawing
      << (given.yes ? "This is the first motion of this robot: --yes is not enough. " : "") << what
      << (moves(what)
              ? ": is the area clear and an emergency stop at hand? This program's obstacle stop replaces "
                "neither a safety scanner nor an emergency stop. "
              : " writes to the controller. Nothing moves; the axes have no torque meanwhile. ")
      << besides << "Type yes to go on: " << std::flush;
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "yes") return {};
  return Error{ErrorCode::cancelled, "no consent", what, ""};
}

std::string unseen_question(const ordered_json& plan) {
  const auto unseen = plan.value("unseen_moves", std::vector<std::string>());
  if (unseen.empty()) return {};
  std::string where;
  for (const auto& sector : plan.value("blind_sectors", std::vector<std::array<double, 2>>()))
    where += fmt::format("{}{:.0f} to {:.0f}", where.empty() ? "" : ", ", sector[0] * kDegrees,
                         sector[1] * kDegrees);
  return fmt::format(
      "The lidar does not see {} deg around the robot (0 is ahead, 90 left), and \"{}\" goes there: nothing "
      "but you stops the robot for what is or comes there. ",
      where, fmt::join(unseen, "\", \""));
}

/// Whoever gave the consent.
std::string user_name() {
  const struct passwd* user = getpwuid(getuid());
  return user != nullptr ? user->pw_name : "user " + std::to_string(getuid());
}

/// The values that would be in force afterwards, and what whoever consents vouches for.
std::string write_question(const ordered_json& plan) {
  std::string text;
  if (plan.contains("goes_to")) text = "It goes back to " + plan.value("goes_to", "") + ":";
  const ordered_json after = plan.value("after", ordered_json::object());
  for (const auto& [name, value] : after.items())
    if (!text.empty() && value.is_number())
      text += fmt::format("{} {} {:.3f} mm", text.ends_with(':') ? "" : ",", name, 1e3 * value.get<double>());
  if (!text.empty()) text += ". ";
  for (const auto& what : plan.value("asks", std::vector<std::string>()))
    text += what + ". Is it of this robot? ";
  return text;
}

// Prospect of the motion, or of the write-back, from the daemon that would do it.
Result<Prospect> prospect_of(const Session& session, const std::string& method, ordered_json parameters) {
  parameters["dry_run"] = true;
  const auto answer = call_once(session.socket, method, std::move(parameters));
  if (!answer) return answer.error();
  const auto plan = answer.value().value("result", ordered_json::object());
  if (!moves(method)) return Prospect{"", write_question(plan), false};
  return Prospect{to_text(describe_plan(plan), true, text_columns()), unseen_question(plan),
                  plan.value("first_motion", false)};
}

}  // namespace

Result<ordered_json> run_method(const Session& session, const Consent& given, const std::string& method,
                                ordered_json parameters) {
  Prospect prospect;
  const bool applies = method == "Apply";
  if ((moves(method) || applies || method == "Rollback") && !given.dry_run) {
    auto expected = prospect_of(session, method, parameters);
    if (!expected) return expected.error();
    prospect = std::move(expected).value();
  }
  if (auto agreed = ask(given, method, prospect); !agreed) return agreed.error();
  if (given.dry_run) parameters["dry_run"] = true;
  if (moves(method) && !prospect.besides.empty()) parameters["vouched_by"] = user_name();
  if (applies && !given.dry_run)
    parameters["of_this_robot"] = true;  // whoever consented was told of which it is
  ProgressLine line;
  const auto progress = [&line](const ordered_json& body) {
    line.show(fmt::format("{} {:3.0f} %   Ctrl-C stops the robot", body.value("phase", ""),
                          100.0 * body.value("fraction", 0.0)));
  };
  const auto answer =
      call_with_lease(session.socket, method, std::move(parameters), progress, given.interrupted, given.on);
  if (!answer) return answer.error();
  return answer.value().value("result", ordered_json::object());
}

void add_consent(CLI::App& verb, Consent& consent) {
  verb.add_flag("--yes", consent.yes, "consent: the area is clear, somebody can stop the robot");
  verb.add_flag("--dry-run", consent.dry_run, "check and say what would be done");
}

}  // namespace odomcalib::cli
