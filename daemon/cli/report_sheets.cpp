#include "daemon/cli/report_sheets.hpp"

#include <fmt/format.h>

#include <vector>

#include "daemon/cli/base_drawing.hpp"
#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/plain_words.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/report_sections.hpp"
#include "odomcalib_version.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kSheetStyle =
    R"(body{max-width:60em}h1{margin:0 0 .2em;font-size:1.6em}.lead{font-size:1.15em}
.base{max-width:430px;margin:0 auto}.base text{font-size:15px}.wheel{fill:var(--ink);opacity:.75}
circle.mark{fill:var(--paper);stroke:var(--before);stroke-width:2.5}text.mark{font-weight:600}
.sign{display:flex;gap:2em;margin-top:2.2em}.sign p{flex:1;border-top:1px solid var(--ink);padding-top:.2em}
@media screen and (max-width:600px){.base text{font-size:17px}.sign{gap:1em}}
@media print{@page{size:A4;margin:13mm}body{font-size:9.5pt}.base{max-width:96mm}h2{margin:.8em 0 .1em;font-size:1.05em}
.sheet table{font-size:9pt}.filed table{font-size:8.3pt}.filed td,.filed th{padding:.08em .4em}table{break-inside:avoid}}
)";

std::string paragraph(const std::string& text, const char* style = "") {
  return text.empty() ? "" : fmt::format("<p{}>{}</p>\n", style, escaped(text));
}

std::string heading(const Calibration& calibration, const std::string& title) {
  return fmt::format("<h1 class=\"{}\">{}</h1>\n", class_of(tone_of(calibration.verdict)), escaped(title));
}

std::vector<Finding> all_findings(const Calibration& calibration) {
  std::vector<Finding> findings = effect_findings(calibration);
  for (Finding& one : dimension_findings(calibration)) findings.push_back(std::move(one));
  if (calibration.verdict == Verdict::refused)
    for (Finding& one : findings) one.remedy = "nothing: the calibration is refused";
  return findings;
}

Table table_of(const std::vector<Finding>& findings) {
  Table table{{"", "what was found", "look at", "what the software does"}, {}};
  for (std::size_t k = 0; k < findings.size(); ++k)
    table.rows.push_back({std::to_string(k + 1), findings[k].what,
                          findings[k].look_at.empty() ? "-" : findings[k].look_at, findings[k].remedy});
  return table;
}

/// Effects that nobody can recognise from this drive.
std::string untested_line(const ReportData& data) {
  std::string names, last;
  for (const Detectable& effect : data.detectable) {
    if (effect.smallest && *effect.smallest < effect.typical) continue;
    if (const std::string name = readable(effect.effect); name != last)
      names += (names.empty() ? "" : ", ") + name;
    last = readable(effect.effect);
  }
  return names.empty() ? "" : "Not tested by this drive: " + names + ".";
}

std::string unnamed_line(const Calibration& calibration) {
  if (!calibration.unexplained) return "";
  std::string on;
  for (const std::string& variable : calibration.unexplained->depends_on)
    on += (on.empty() ? "" : ", ") + readable(variable);
  return "Something without a name is left, which depends on " + on + ".";
}

/// The metre that all lengths stand on.
std::string metre_line(const Calibration& calibration) {
  const auto& scale = calibration.scale;
  if (!scale) return "All lengths stand on the metre of the reference, of which nothing is known.";
  return fmt::format(
      "All lengths stand on the metre of the reference: {:.6g} m by {}, known to +-{:.3g} % (two "
      "deviations).",
      scale->value, scale->source == "lidar data sheet" ? "the lidar's data sheet" : "a tape",
      100.0 * 2.0 * scale->std / scale->value);
}

Section filed_section(const Calibration& calibration, const std::string& file, const std::string& sha256) {
  Section section{"", {}, {}};
  const auto add = [&section](const char* what, const std::string& text) {
    section.table.rows.push_back({what, text.empty() ? "-" : text});
  };
  const auto& driven = calibration.driven;
  add("robot", calibration.robot.robot_id);
  add("controller", calibration.robot.controller);
  add("place", settings_of(calibration).place);
  add("driven", driven ? utc_text(driven->begin) + " to " + utc_text(driven->end) : "");
  for (const DataUse& data : calibration.data)
    add("recording", fmt::format("{}, {:.0f} s; SHA-256 {}", data.name, data.duration, data.sha256));
  add("calibration file", file + "; SHA-256 " + sha256);
  const std::string version = settings_of(calibration).version;
  add("solved by", version.empty() ? "" : "odomcalib " + version);
  add("certificate by", std::string("odomcalib ") + kVersion);
  if (const std::string note = settings_of(calibration).note; !note.empty()) add("note", note);
  return section;
}

}  // namespace

std::string mechanics_sheet(const Calibration& calibration) {
  const ReportData data = report_data_of(calibration);
  const std::vector<Finding> findings = all_findings(calibration);
  const std::string title =
      "What was found on " + (calibration.robot.robot_id.empty() ? "the robot" : calibration.robot.robot_id);
  std::string body = heading(calibration, title) + paragraph(subject_line(calibration)) +
                     paragraph(gain_sentence(calibration, data), " class=\"lead\"");
  body += "<figure>\n" + base_drawing(calibration, findings) +
          "<figcaption>From above; wheels, track width and lidar to scale. Numbers: see below. Lidar in "
          "blue: where it "
          "was found; in grey: where it was stated.</figcaption></figure>\n";
  body += findings.empty() ? paragraph("Nothing differs from what was stated.") : html_of(table_of(findings));
  body += paragraph(unnamed_line(calibration)) + paragraph(untested_line(data));
  body += "<h2>" + headline(calibration.verdict) + "</h2>\n";
  for (const std::string& line : verdict_section(calibration).lines) body += paragraph(line);
  return page_of(title, kSheetStyle, "<div class=\"sheet\">\n" + body + "</div>\n");
}

std::string certificate(const Calibration& calibration, const std::string& file, const std::string& sha256) {
  const ReportData data = report_data_of(calibration);
  std::string body =
      heading(calibration, "Certificate of calibration") +
      paragraph(headline(calibration.verdict) + ". " + gain_sentence(calibration, data), " class=\"lead\"");
  body += html_of(filed_section(calibration, file, sha256).table);
  Section values = parameters_section(calibration);
  values.lines = {metre_line(calibration)};
  body += html_of(values);
  Section effects = effects_section(calibration);
  effects.lines = effect_lines(calibration);
  if (!effects.table.rows.empty()) body += html_of(effects);
  body += html_of(drive_errors_section(calibration, data, true));
  for (const std::string& reason : calibration.reasons) body += paragraph("Warning: " + reason);
  body += "<div class=\"sign\"><p>date</p><p>name</p><p>signature</p></div>\n";
  return page_of("Certificate of calibration: " + subject_line(calibration), kSheetStyle,
                 "<div class=\"filed\">\n" + body + "</div>\n");
}

}  // namespace odomcalib::cli
