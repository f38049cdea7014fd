#include "daemon/cli/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/document.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/plain_words.hpp"
#include "daemon/cli/report_figures.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

constexpr const char* kReportStyle = R"(body{max-width:88em;margin:1.2em auto}
header{display:flex;flex-wrap:wrap;align-items:baseline;gap:.2em 1.4em}header h1{margin:0;font-size:1.7em}
header p{margin:0}.lead{font-size:1.2em;margin:.7em 0}
.first{display:grid;gap:0 2.6em;grid-template:"answer" "gain" "values"/minmax(0,1fr)}
.answer{grid-area:answer}.gain{grid-area:gain}.values{grid-area:values}
.first section{margin:0}.first h2{margin:.9em 0 .2em}.first figure{margin:.5em 0}.first figure svg{max-width:none}
.first td,.first th{padding:.16em .5em}.first td.n{white-space:nowrap}
.sizes{display:flex;flex-wrap:wrap;gap:.6em 2.6em}.sizes p{margin:0}
.sizes .v{font-size:2em;line-height:1.15;font-variant-numeric:tabular-nums;white-space:nowrap}
.sizes .v .b{color:var(--before)}.sizes .v .a{color:var(--after);font-weight:600}
.next{border:1px solid var(--rule);border-radius:.4em;padding:.3em .8em;margin-top:.8em}
.next p:last-child{font-weight:600}
.rest{margin-top:1.6em}details{border-top:1px solid var(--rule)}details:last-of-type{border-bottom:1px solid var(--rule)}
summary{cursor:pointer;font-weight:600;padding:.55em 0}
details h2{font-size:1em}details>section{margin-bottom:1.2em}details>section:first-of-type>h2{margin-top:.4em}
@media screen and (min-width:1100px){
.first td{white-space:nowrap}.first table{font-size:.95em}
.first{grid-template:"answer gain" auto "values gain" 1fr/minmax(0,1fr) minmax(0,1fr)}
.fold{columns:2;column-gap:2.6em}.fold>*{break-inside:avoid}.fold.wide{columns:1}
.fold.wide figure{display:inline-block;width:48%;margin-right:1.5%;vertical-align:top}}
@media screen and (max-width:600px){body{margin:.6em auto}header h1{font-size:1.4em}
.lead{font-size:1.05em;margin:.4em 0}.sizes{gap:.3em 1.2em}.sizes .v{font-size:1.4em}.sizes p{font-size:.92em}}
@media print{@page{size:A4;margin:13mm}body{font-size:9.5pt}.rest{break-before:page;margin:0}
details::details-content{content-visibility:visible;display:block;block-size:auto}
summary{break-after:avoid;list-style:none;font-size:1.15em;padding:.4em 0}summary::marker{content:""}
table,figure{break-inside:avoid}p:has(+table),p:has(+figure){break-after:avoid}.gain{display:flex;gap:6mm}.gain figure{flex:1;max-width:125mm}
.gain figure>svg,.fold figure>svg{max-width:none}.fold table{font-size:8.5pt}.fold td,.fold th{padding:.1em .4em}
.fold figure{display:inline-block;width:88mm;margin:.3em 2mm .3em 0;vertical-align:top}.fold h2{margin:.7em 0 .1em}
.fold>section{margin-bottom:.5em}svg text{font-size:17px}}
)";

/// A refused calibration has no gain to be proud of: the sentence says what it would be.
std::string sizes_of(const Calibration& calibration, const std::vector<Gain>& gains) {
  if (calibration.verdict == Verdict::refused) return "";
  std::string out;
  for (const Gain& gain : gains) {
    std::string sizes;
    if (gain.before) sizes += fmt::format("<span class=\"b\">{}</span>", plain_number(*gain.before));
    if (gain.before && gain.after) sizes += " &rarr; ";
    if (gain.after) sizes += fmt::format("<span class=\"a\">{}</span>", plain_number(*gain.after));
    out += fmt::format("<div><p class=\"v\">{}{}</p><p>{}{}</p></div>\n", sizes,
                       gain.unit == "degrees" ? "&deg;" : " mm", escaped(gain.what),
                       gain.before && gain.after ? ": before, now" : " is off by");
  }
  return out.empty() ? "" : "<div class=\"sizes\">\n" + out + "</div>\n";
}

/// Figures of the gain on data that was not fitted: how the error grows with the way; where an effect was
/// found, also the residual over its variable.
std::vector<Figure> first_figures(const Calibration& calibration, const ReportData& data) {
  std::vector<Figure> figures;
  if (!data.growth.empty()) {
    figures.push_back(figure_of_growth(data.growth, !calibration.effects.empty()));
    if (calibration.verdict == Verdict::refused) figures.back().curves.back().label = "by the refused values";
  }
  if (!data.traces.empty()) figures.push_back(figure_of_trace(data.traces.front()));
  if (figures.empty() && !data.paths.empty()) figures.push_back(figure_of_paths(data.paths));
  return figures;
}

/// The reasons and what to do, in a frame.
std::string next_of(const Calibration& calibration) {
  std::string out = "<div class=\"next\">\n";
  for (const std::string& line : verdict_section(calibration).lines)
    out += fmt::format("<p>{}</p>\n", escaped(line));
  return out + "</div>\n";
}

std::string found_of(const Calibration& calibration) {
  std::string out;
  for (const std::string& line : effect_lines(calibration)) out += fmt::format("<p>{}</p>\n", escaped(line));
  return out.empty() ? "" : "<section><h2>Found besides</h2>\n" + out + "</section>\n";
}

std::string values_of(const Calibration& calibration) {
  Section values = parameters_section(calibration);
  if (values.table.rows.empty()) return "";
  if (calibration.verdict == Verdict::refused) values.title = "What was measured, not to be used";
  std::string out = "<section><h2>" + escaped(values.title) + "</h2>\n" + html_of(values.table);
  for (const std::string& line : values.lines) out += fmt::format("<p>{}</p>\n", escaped(line));
  return out + "</section>\n";
}

std::string first_screen(const Calibration& calibration, const ReportData& data) {
  std::string gain;
  for (const Figure& figure : first_figures(calibration, data)) gain += html_of(figure);
  return fmt::format(
      "<div class=\"first\">\n<div class=\"answer\">\n{}{}</div>\n<div class=\"gain\">\n{}</div>\n"
      "<div class=\"values\">\n{}{}</div>\n</div>\n",
      sizes_of(calibration, gains_of(calibration, data)), next_of(calibration), gain, found_of(calibration),
      values_of(calibration));
}

std::string rest_of(const Calibration& calibration, const std::vector<Section>& written) {
  std::string out = "<div class=\"rest\">\n";
  for (const auto& [title, sections] : folded_sections(calibration, written)) {
    // Narrower columns would break the tables of fewer.
    const char* columns = sections.size() < 3 ? " wide" : "";
    out += fmt::format("<details><summary>{}</summary>\n<div class=\"fold{}\">\n", escaped(title), columns);
    for (Section section : sections) {
      if (section.title == title) section.title.clear();
      out += html_of(section);
    }
    out += "</div></details>\n";
  }
  return out + "</div>\n";
}

}  // namespace

std::string subject_line(const Calibration& calibration) {
  std::vector<std::string> parts;
  if (!calibration.robot.robot_id.empty()) parts.push_back(calibration.robot.robot_id);
  if (const std::string place = settings_of(calibration).place; !place.empty()) parts.push_back(place);
  if (const auto& driven = calibration.driven)
    parts.push_back("driven " + utc_span(driven->begin, driven->end));
  for (const DataUse& data : calibration.data)
    if (parts.empty() || !calibration.driven) parts.push_back(data.name);
  std::string line;
  for (const std::string& part : parts) line += (line.empty() ? "" : " \u00b7 ") + part;
  return line;
}

std::string report_page(const Calibration& calibration, const std::vector<Section>& written) {
  const ReportData data = report_data_of(calibration);
  const std::string verdict = headline(calibration.verdict);
  const std::string gain = gain_sentence(calibration, data);
  std::string body =
      fmt::format("<header><h1 class=\"{}\">{}</h1><p>{}</p></header>\n",
                  class_of(tone_of(calibration.verdict)), verdict, escaped(subject_line(calibration)));
  if (!gain.empty()) body += fmt::format("<p class=\"lead\">{}</p>\n", escaped(gain));
  body += first_screen(calibration, data) + rest_of(calibration, written);
  return page_of(verdict + ": " + subject_line(calibration), kReportStyle, body);
}

}  // namespace odomcalib::cli
