#include "daemon/service/solution.hpp"

#include <fmt/format.h>

#include "daemon/service/json_text.hpp"
#include "proto/control/control.hpp"

namespace odomcalib {
namespace {

using nlohmann::ordered_json;

std::string reply_with(const Calibrator& calibrator, const Calibration& calibration, const std::string& text,
                       const std::filesystem::path& recording) {
  ordered_json report = {{"recording", recording.string()}, {"calibration", ordered_json::parse(text)}};
  const auto next = calibrator.next_manoeuvre ? calibrator.next_manoeuvre(calibration) : std::nullopt;
  if (next) report["next"] = {{"manoeuvre", next->name}, {"why", next->why}};
  return control::encode_reply(json_text({{"result", report}}));
}

std::string in_a_line(const Calibration& calibration, const std::filesystem::path& recording) {
  std::string line = recording.filename().string() + ": " + name_of(calibration.verdict);
  for (const auto& [name, quantity] : calibration.parameters)
    line += fmt::format(", {} {:.6g} ± {:.2g} {}", name, quantity.value, quantity.std, quantity.unit);
  for (const std::string& reason : calibration.reasons) line += "; " + reason;
  return line;
}

}  // namespace

Solution solution_of(const Calibrator& calibrator, const Calibration& calibration,
                     const std::filesystem::path& recording) {
  Solution solution;
  solution.calibration = to_json(calibration);
  solution.reply = reply_with(calibrator, calibration, solution.calibration, recording);
  solution.line = in_a_line(calibration, recording);
  solution.paths = report_data_of(calibration).paths;
  return solution;
}

}  // namespace odomcalib
