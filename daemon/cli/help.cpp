#include "daemon/cli/help.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <sstream>
#include <string>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/text_layout.hpp"

namespace odomcalib::cli {
namespace {

constexpr std::size_t kColumns = 80;  // of a terminal as it opens
constexpr std::size_t kIndent = 30;   // where descriptions begin

struct Examples {
  const char* verb;
  std::array<const char*, 2> calls;
};

/// They run as they stand: tests/integration/verbs_table.py tries each.
constexpr std::array kExamples = {
    Examples{
        "solve",
        {"solve drive.jsonl.gz --out cal.json", "solve drive.jsonl.gz --robot robot.toml --effects none"}},
    Examples{"predict",
             {"predict drive.jsonl.gz --calibration cal.json --trajectory t.tum",
              "predict drive.jsonl.gz --calibration nominal --trajectory t.tum"}},
    Examples{"convert",
             {"convert drive.jsonl.gz --out copy.jsonl", "convert drive.jsonl.gz --out copy.jsonl.gz"}},
    Examples{"decode", {"decode ld06 lidar.bin", "decode sick lidar.bin --json"}},
    Examples{"inspect", {"inspect drive.jsonl.gz", "inspect drive.jsonl.gz --json"}},
    Examples{"compare", {"compare cal.json later.json", "compare cal.json later.json --trend --until 5mm/m"}},
    Examples{"match", {"match pairs.jsonl", "match pairs.jsonl --matcher brute"}},
    Examples{"report", {"report cal.json", "report cal.json --html report.html"}},
    Examples{"export",
             {"export cal.json --what toml", "export cal.json --what diff_drive --into controllers.yaml"}},
    Examples{"graph",
             {"graph build drive.jsonl.gz --out map.g2o", "graph optimize map.g2o --out better.g2o"}},
    Examples{"graph build",
             {"graph build drive.jsonl.gz --out map.g2o", "graph build drive.jsonl.gz --out map.g2o --json"}},
    Examples{"graph info", {"graph info map.g2o", "graph info map.g2o --json"}},
    Examples{"graph optimize",
             {"graph optimize map.g2o --out better.g2o", "graph optimize map.g2o --out better.g2o --json"}},
    Examples{"status", {"status", "status --json"}},
    Examples{"check", {"check", "check --nudge"}},
    Examples{"monitor", {"monitor", "monitor --json=short"}},
    Examples{"view", {"view", "view --port 8080"}},
    Examples{"wait", {"wait --timeout 5", "wait --until idle --timeout 5"}},
    Examples{"record", {"record", "record --duration 60"}},
    Examples{"straight", {"straight", "straight --dry-run"}},
    Examples{"spin", {"spin", "spin --dry-run"}},
    Examples{"calibrate", {"calibrate --dry-run", "calibrate --out cal.json --apply"}},
    Examples{"stop", {"stop", "stop --json"}},
    Examples{"apply", {"apply cal.json --dry-run", "apply cal.json"}},
    Examples{"history", {"history", "history --json"}},
    Examples{"rollback", {"rollback", "rollback --dry-run"}},
    Examples{"params", {"params get", "params set track_width=0.402"}},
    Examples{"params get", {"params get", "params get --json"}},
    Examples{"params set",
             {"params set track_width=0.402", "params set left_wheel_diameter=0.1501 --dry-run"}},
    Examples{"params diff", {"params diff", "params diff --json"}}};

/// The verb and those above it, without the program.
std::string path_of(const CLI::App& app) {
  if (app.get_parent() == nullptr) return "";
  const std::string above = path_of(*app.get_parent());
  return above.empty() ? app.get_name() : above + " " + app.get_name();
}

/// A name, and beside it what it means; below it where the name is long.
std::string in_two_columns(const std::string& name, const std::string& text) {
  std::string out = name;
  std::istringstream lines(wrapped(text, kColumns - kIndent));
  bool is_begun = name.size() + 1 < kIndent;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    if (!is_begun) out += "\n";
    out += std::string(is_begun ? kIndent - out.size() : kIndent, ' ') + line.substr(first);
    is_begun = false;
  }
  return out + "\n";
}

class HelpText : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string type = make_option_opts(option), text = make_option_desc(option);
    // Choices read better as words than as a set in the name of the type.
    const auto begin = type.find(":{"), end = type.rfind('}');
    if (begin != std::string::npos && end != std::string::npos) {
      std::string choices = type.substr(begin + 2, end - begin - 2);
      for (auto comma = choices.find(','); comma != std::string::npos; comma = choices.find(',', comma + 2))
        choices.insert(comma + 1, " ");
      text += (text.empty() ? "" : "; ") + ("one of " + choices);
      type.erase(begin, end - begin + 1);
    }
    return in_two_columns("  " + make_option_name(option, is_positional) + type, text);
  }

  std::string make_subcommand(const CLI::App* verb) const override {
    return in_two_columns("  " + verb->get_name(), verb->get_description());
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), kColumns);
  }

  std::string make_footer(const CLI::App* app) const override {
    const std::string path = path_of(*app);
    if (path.empty()) return "\n" + exit_status_help();
    const auto* found = std::find_if(kExamples.begin(), kExamples.end(),
                                     [&](const Examples& one) { return one.verb == path; });
    std::string text;
    if (found != kExamples.end()) {
      text += "Examples:\n";
      for (const char* call : found->calls) text += "  odomcalibctl " + std::string(call) + "\n";
    }
    return text + "\nExit statuses: odomcalibctl --help, or man odomcalibctl\n";
  }
};

}  // namespace

void lay_out_help(CLI::App& app) { app.formatter(std::make_shared<HelpText>()); }

}  // namespace odomcalib::cli
