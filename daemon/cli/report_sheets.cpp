#include "daemon/cli/report_sheets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <vector>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/figure_svg.hpp"
#include "daemon/cli/plain_words.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/report_sections.hpp"
#include "odomcalib_version.hpp"
#include "proto/base_quantities.hpp"
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

// Drawing units; the page scales the whole. Forward is up, as the robot is seen from above.
constexpr double kWidth = 460.0, kHeight = 390.0;
constexpr double kTrack = 220.0;                      // what the track width is drawn as
constexpr double kMiddleX = 230.0, kMiddleY = 225.0;  // of the axle
constexpr double kMarker = 13.0;                      // radius of a number's circle
constexpr double kNear = 20.0, kFar = 370.0;          // where a mark still lies within the drawing
constexpr std::array<double, 2> kShortestWheel = {40.0, 160.0};

/// The base of a robot from above as inline SVG, to scale: wheels, lidar where it was found and where it was
/// stated. Findings are numbered from one in their order.
class BaseDrawing {
 public:
  explicit BaseDrawing(const Calibration& calibration) : calibration_(calibration) {
    const double track = length(BaseQuantity::track_width).value_or(0.0);
    scale_ = track > 0.0 ? kTrack / track : 0.0;
  }

  std::string svg(const std::vector<Finding>& findings) {
    fmt::format_to(
        out(), "<svg class=\"base\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"the base from above\">\n",
        kWidth, kHeight);
    body();
    wheel(-1.0, length(BaseQuantity::left_wheel_diameter));
    wheel(1.0, length(BaseQuantity::right_wheel_diameter));
    lidars();
    for (std::size_t k = 0; k < findings.size(); ++k) marker(findings[k].spot, k + 1);
    return text_ + "</svg>\n";
  }

 private:
  std::back_insert_iterator<std::string> out() { return std::back_inserter(text_); }

  [[nodiscard]] std::optional<double> length(BaseQuantity of) const {
    if (const auto value = calibration_.parameter(of); value && *value > 0.0) return value;
    return nominal_value(calibration_.robot, of);
  }

  /// Drawing coordinates of a place on the base, m forward and to the left.
  [[nodiscard]] std::array<double, 2> at(double x, double y) const {
    return {std::clamp(kMiddleX - scale_ * y, kNear, kFar), std::clamp(kMiddleY - scale_ * x, kNear, kFar)};
  }

  void body() {
    fmt::format_to(out(), "<rect class=\"l r\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"40\"/>\n",
                   kMiddleX - 88.0, kMiddleY - 150.0, 176.0, 250.0);
    fmt::format_to(out(), "<path class=\"l r\" d=\"M{0} {1}v-34m-9 12l9 -14l9 14\"/>", kMiddleX,
                   kMiddleY - 172.0 + 12.0);
    fmt::format_to(out(), "<text class=\"m\" x=\"{}\" y=\"{}\">forward</text>\n", kMiddleX + 46.0,
                   kMiddleY - 176.0);
    fmt::format_to(out(), "<path class=\"g\" d=\"M{} {}H{}\"/>\n", kMiddleX - kTrack / 2.0, kMiddleY,
                   kMiddleX + kTrack / 2.0);
  }

  void wheel(double side, std::optional<double> diameter) {
    const double size = diameter && scale_ > 0.0
                            ? std::clamp(scale_ * *diameter, kShortestWheel[0], kShortestWheel[1])
                            : 80.0;
    constexpr double kBreadth = 24.0;
    fmt::format_to(
        out(), "<rect class=\"wheel\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" rx=\"5\"/>\n",
        kMiddleX + side * kTrack / 2.0 - kBreadth / 2.0, kMiddleY - size / 2.0, kBreadth, size);
  }

  void lidar(const char* tone, const std::array<double, 3>& pose) {
    const auto [x, y] = at(pose[0], pose[1]);
    constexpr double kRadius = 17.0, kBeam = 32.0;
    fmt::format_to(out(),
                   "<circle class=\"l {0}\" cx=\"{1:.1f}\" cy=\"{2:.1f}\" r=\"{3}\"/><path class=\"l {0}\" "
                   "d=\"M{1:.1f} {2:.1f}L{4:.1f} {5:.1f}\"/>\n",
                   tone, x, y, kRadius, x - kBeam * std::sin(pose[2]), y - kBeam * std::cos(pose[2]));
  }

  void lidars() {
    if (calibration_.robot.lidar_pose) lidar("r", *calibration_.robot.lidar_pose);
    const auto pose = found_lidar();
    if (pose) lidar("a", *pose);
  }

  [[nodiscard]] std::optional<std::array<double, 3>> found_lidar() const {
    const auto x = calibration_.parameter(BaseQuantity::lidar_x),
               y = calibration_.parameter(BaseQuantity::lidar_y),
               yaw = calibration_.parameter(BaseQuantity::lidar_yaw);
    if (!x || !y || !yaw) return std::nullopt;
    return std::array{*x, *y, *yaw};
  }

  /// Where the first number of a spot stands; others stand beside it.
  [[nodiscard]] std::array<double, 2> place_of(Spot spot) const {
    switch (spot) {
      case Spot::left_wheel:
        return {kMiddleX - kTrack / 2.0 - 34.0, kMiddleY};
      case Spot::right_wheel:
        return {kMiddleX + kTrack / 2.0 + 34.0, kMiddleY};
      case Spot::axle:
        return {kMiddleX, kMiddleY};
      case Spot::caster:
        return {kMiddleX, kMiddleY + 76.0};
      case Spot::lidar: {
        const auto pose = found_lidar().value_or(std::array{0.25, 0.0, 0.0});
        const auto [x, y] = at(pose[0], pose[1]);
        return {x + 38.0, y};
      }
      case Spot::clocks:
        return {40.0, 40.0};
      case Spot::floor:
        break;
    }
    return {40.0, kHeight - 30.0};
  }

  void marker(Spot spot, std::size_t number) {
    const std::size_t before = taken_[spot]++;
    auto [x, y] = place_of(spot);
    const bool outside = spot == Spot::clocks || spot == Spot::floor;
    if (before == 0 && outside)
      fmt::format_to(out(), "<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x - kMarker, y - kMarker - 6.0,
                     spot == Spot::clocks ? "clocks" : "floor");
    const double step = 2.0 * kMarker + 4.0;
    // Beside a wheel there is room up and down, elsewhere to the right.
    const bool wheel = spot == Spot::left_wheel || spot == Spot::right_wheel;
    (wheel ? y : x) += step * static_cast<double>(before);
    fmt::format_to(out(),
                   "<circle class=\"mark\" cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2}\"/><text class=\"m mark\" "
                   "x=\"{0:.1f}\" y=\"{3:.1f}\">{4}</text>\n",
                   x, y, kMarker, y + 5.0, number);
  }

  const Calibration& calibration_;
  double scale_ = 0.0;  ///< drawing units in a metre; 0: the track width is not known
  std::map<Spot, std::size_t> taken_;
  std::string text_;
};

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
  body += "<figure>\n" + BaseDrawing(calibration).svg(findings) +
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
