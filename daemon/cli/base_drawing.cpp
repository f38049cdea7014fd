#include "daemon/cli/base_drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

#include "proto/base_quantities.hpp"

namespace odomcalib::cli {
namespace {

// Drawing units; the page scales the whole. Forward is up, as the robot is seen from above.
constexpr double kWidth = 460.0, kHeight = 390.0;
constexpr double kTrack = 220.0;                      // what the track width is drawn as
constexpr double kMiddleX = 230.0, kMiddleY = 225.0;  // of the axle
constexpr double kMarker = 13.0;                      // radius of a number's circle
constexpr double kNear = 20.0, kFar = 370.0;          // where a mark still lies within the drawing
constexpr std::array<double, 2> kShortestWheel = {40.0, 160.0};

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

}  // namespace

std::string base_drawing(const Calibration& calibration, const std::vector<Finding>& findings) {
  return BaseDrawing(calibration).svg(findings);
}

}  // namespace odomcalib::cli
