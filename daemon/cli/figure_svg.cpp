#include "daemon/cli/figure_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace odomcalib::cli {
namespace {

// Drawing units; the page scales the whole.
constexpr double kWidth = 680.0;
constexpr double kHeight = 340.0;
constexpr double kMapHeight = 460.0;
constexpr double kLeft = 70.0, kRight = 14.0, kTop = 12.0, kBottom = 62.0;
constexpr double kMargin = 0.04;  // of the range, so that nothing touches the frame

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] double length() const { return high - low; }
  void widen() {
    if (!(length() > 0.0)) {
      const double half = std::max(1e-9, 0.1 * std::abs(low));
      low -= half;
      high += half;
    }
    const double margin = kMargin * length();
    low -= margin;
    high += margin;
  }
  void grow_to(double wanted) {
    const double more = std::max(0.0, wanted - length()) / 2.0;
    low -= more;
    high += more;
  }
};

bool drawable(const std::array<double, 2>& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]);
}

class Drawing {
 public:
  explicit Drawing(const Figure& figure)
      : figure_(figure), height_(figure.equal_scales ? kMapHeight : kHeight) {
    for (const Curve& curve : figure.curves)
      for (std::size_t k = 0; k < curve.points.size(); ++k) take(curve, k);
  }

  [[nodiscard]] bool empty() const { return x_.empty() || y_.empty(); }

  std::string svg() {
    settle_scales();
    fmt::format_to(out(), "<svg{} viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                   figure_.equal_scales ? " class=\"map\"" : "", kWidth, height_, escaped(figure_.caption));
    frame();
    for (const Curve& curve : figure_.curves) draw(curve);
    return text_ + "</svg>\n";
  }

 private:
  std::back_insert_iterator<std::string> out() { return std::back_inserter(text_); }

  void take(const Curve& curve, std::size_t k) {
    if (!drawable(curve.points[k])) return;
    const double error = k < curve.errors.size() && std::isfinite(curve.errors[k]) ? curve.errors[k] : 0.0;
    x_.take(curve.points[k][0]);
    y_.take(curve.points[k][1] - error);
    y_.take(curve.points[k][1] + error);
  }

  void settle_scales() {
    x_.widen();
    y_.widen();
    if (!figure_.equal_scales) return;
    const double ratio = (kWidth - kLeft - kRight) / (height_ - kTop - kBottom);
    x_.grow_to(y_.length() * ratio);
    y_.grow_to(x_.length() / ratio);
  }

  [[nodiscard]] double px(double x) const {
    return kLeft + (x - x_.low) / x_.length() * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double py(double y) const {
    return height_ - kBottom - (y - y_.low) / y_.length() * (height_ - kTop - kBottom);
  }

  void frame() {
    for (const double x : axis_marks(x_.low, x_.high, 7))
      fmt::format_to(out(),
                     "<path class=\"g\" d=\"M{0:.1f} {1:.1f}V{2:.1f}\"/>"
                     "<text class=\"m\" x=\"{0:.1f}\" y=\"{3:.1f}\">{4:g}</text>\n",
                     px(x), kTop, height_ - kBottom, height_ - kBottom + 21.0, x);
    for (const double y : axis_marks(y_.low, y_.high, 6))
      fmt::format_to(out(),
                     "<path class=\"g\" d=\"M{0:.1f} {1:.1f}H{2:.1f}\"/>"
                     "<text class=\"e\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5:g}</text>\n",
                     kLeft, py(y), kWidth - kRight, kLeft - 6.0, py(y) + 4.0, y);
    fmt::format_to(out(), "<text class=\"m\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                   (kLeft + kWidth - kRight) / 2.0, height_ - 10.0, escaped(figure_.x_label));
  }

  void draw(const Curve& curve) {
    if (curve.style == Curve::Style::dots) return dots(curve);
    std::string path;
    bool pen_down = false;
    for (const auto& point : curve.points) {
      if (!drawable(point)) {
        pen_down = false;
        continue;
      }
      const bool step = curve.style == Curve::Style::steps && pen_down;
      if (step)
        fmt::format_to(std::back_inserter(path), "H{:.1f}V{:.1f}", px(point[0]), py(point[1]));
      else
        fmt::format_to(std::back_inserter(path), "{}{:.1f} {:.1f}", pen_down ? "L" : "M", px(point[0]),
                       py(point[1]));
      pen_down = true;
    }
    append("l", curve, path);
    bars(curve);
  }

  void dots(const Curve& curve) {
    // Zero-length strokes with round caps: one element instead of hundreds of circles.
    std::string path;
    for (const auto& point : curve.points)
      if (drawable(point))
        fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}h0", px(point[0]), py(point[1]));
    append("d", curve, path);
    bars(curve);
  }

  void bars(const Curve& curve) {
    std::string path;
    for (std::size_t k = 0; k < curve.errors.size() && k < curve.points.size(); ++k) {
      const auto& point = curve.points[k];
      if (!drawable(point) || !std::isfinite(curve.errors[k])) continue;
      fmt::format_to(std::back_inserter(path), "M{:.1f} {:.1f}V{:.1f}", px(point[0]),
                     py(point[1] - curve.errors[k]), py(point[1] + curve.errors[k]));
    }
    if (!path.empty()) append("l", curve, path);
  }

  /// A pointer that rests on a curve shows its name.
  void append(const char* style, const Curve& curve, const std::string& path) {
    fmt::format_to(out(), "<path class=\"{} {}\" d=\"{}\"><title>{}</title></path>\n", style,
                   class_of(curve.tone), path, escaped(curve.label));
  }

  const Figure& figure_;
  double height_;
  Range x_, y_;
  std::string text_;
};

}  // namespace

const char* class_of(Curve::Tone tone) {
  if (tone == Curve::Tone::before) return "b";
  return tone == Curve::Tone::after ? "a" : "r";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::vector<double> axis_marks(double low, double high, int wanted) {
  std::vector<double> marks;
  if (!(high > low) || wanted < 1) return marks;
  const double raw = (high - low) / wanted;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * decade;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * decade >= raw * 0.999) step = factor * decade;
  for (double k = std::ceil(low / step); k * step <= high; k += 1.0)
    marks.push_back(k == 0.0 ? 0.0 : k * step);
  return marks;
}

std::string to_svg(const Figure& figure) {
  Drawing drawing(figure);
  return drawing.empty() ? "" : drawing.svg();
}

}  // namespace odomcalib::cli
