#include "drivers/lidar/scip/reply.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "drivers/lidar/scip/settings.hpp"

namespace odomcalib::drivers::scip {
namespace {

constexpr std::size_t kStampCharacters = 4;

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

/// Takes the sum off the end of a line; false when it is wrong. In parameter lines a semicolon stands before
/// it.
bool strip_sum(std::string& line) {
  if (line.size() < 2) return false;
  const char sum = line.back();
  line.pop_back();
  if (line.back() == ';' && sum_of(line.substr(0, line.size() - 1)) == sum) {
    line.pop_back();
    return true;
  }
  return sum_of(line) == sum;
}

/// Fixed-width decimal field of an echo.
std::optional<unsigned> field(const std::string& echo, std::size_t at, std::size_t width) {
  if (echo.size() < at + width) return std::nullopt;
  unsigned value = 0;
  const char* begin = echo.data() + at;
  const auto parsed = std::from_chars(begin, begin + width, value);
  const bool whole = parsed.ec == std::errc{} && parsed.ptr == begin + width;
  return whole ? std::optional(value) : std::nullopt;
}

/// Characters that hold six bits each, the most significant first.
class Values {
 public:
  explicit Values(std::string_view text) : rest_(text) {}

  std::uint32_t take(std::size_t characters) {
    if (characters > rest_.size()) return ok_ = false, rest_ = {}, 0;
    std::uint32_t value = 0;
    for (const char c : rest_.substr(0, characters)) {
      ok_ = ok_ && c >= '0' && c < '0' + 64;
      value = value << 6U | (static_cast<std::uint32_t>(c - '0') & 63U);
    }
    rest_.remove_prefix(characters);
    return value;
  }
  /// Whether another echo of the same step follows.
  bool more_echoes() {
    if (rest_.empty() || rest_.front() != '&') return false;
    rest_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

/// How a command's data are laid out.
struct Layout {
  std::size_t characters = 3;
  bool intensity = false;
};

/// M: stream, G: one scan, H and N: the same with several echoes; D: three characters, S: two, E: with
/// intensity.
std::optional<Layout> layout_of(const std::string& echo) {
  if (echo.size() < 2 || std::string_view("MGHN").find(echo[0]) == std::string_view::npos)
    return std::nullopt;
  if (echo[1] == 'D') return Layout{3, false};
  if (echo[1] == 'S') return Layout{2, false};
  if (echo[1] == 'E') return Layout{3, true};
  return std::nullopt;
}

/// The first of several echoes is kept.
bool read_values(std::string_view text, const Layout& layout, Measurement& out) {
  Values values(text);
  while (!values.at_end() && values.ok()) {
    out.ranges_mm.push_back(values.take(layout.characters));
    if (layout.intensity) out.intensities.push_back(values.take(layout.characters));
    while (values.ok() && values.more_echoes()) {
      (void)values.take(layout.characters);
      if (layout.intensity) (void)values.take(layout.characters);
    }
  }
  return values.ok();
}

std::optional<Measurement> read_measurement(const Reply& reply, const Layout& layout) {
  const auto first = field(reply.echo, 2, 4), last = field(reply.echo, 6, 4),
             cluster = field(reply.echo, 10, 2);
  if (!first || !last || !cluster || *last < *first || reply.lines.empty()) return std::nullopt;
  Measurement out;
  out.first_step = *first;
  out.last_step = *last;
  out.cluster = std::max(1U, *cluster);
  Values stamp(reply.lines.front());
  out.stamp_ms = stamp.take(kStampCharacters);
  if (!stamp.ok() || !stamp.at_end()) return std::nullopt;
  std::string joined;
  for (std::size_t i = 1; i < reply.lines.size(); ++i) joined += reply.lines[i];
  if (!read_values(joined, layout, out)) return std::nullopt;
  const std::size_t expected = (out.last_step - out.first_step) / out.cluster + 1;
  return out.ranges_mm.size() == expected ? std::optional(std::move(out)) : std::nullopt;
}

/// A stream's data come with status 99, a single scan's with 00.
bool holds_data(const Reply& reply) {
  const bool stream = reply.echo[0] == 'M' || reply.echo[0] == 'N';
  return reply.status == (stream ? "99" : "00");
}

/// Lines of one reply, the empty one left out. nullptr when all is well.
const char* read_reply(std::vector<std::string> lines, Reply& out) {
  if (lines.size() < 2) return "bad_reply";
  out.echo = lines[0];
  const bool old_style = lines.size() == 2 && lines[1].size() == 1;  // SCIP 1.1 has no sums
  for (std::size_t i = 1; i < lines.size() && !old_style; ++i)
    if (!strip_sum(lines[i])) return "bad_sum";
  out.status = lines[1];
  if (out.status.size() != 2 && !old_style) return "bad_reply";
  out.lines.assign(lines.begin() + 2, lines.end());
  const auto layout = layout_of(out.echo);
  if (!layout || !holds_data(out)) return nullptr;
  out.measurement = read_measurement(out, *layout);
  return out.measurement ? nullptr : "bad_data";
}

Verdict look(Bytes rest, std::vector<Reply>& out) {
  if (rest[0] == '\n') return Verdict::noise();
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
  const std::size_t end = text.substr(0, kMostReplyBytes).find("\n\n");
  if (end == std::string_view::npos)
    return text.size() < kMostReplyBytes ? Verdict::wait() : Verdict::reject("bad_reply", kMostReplyBytes);
  Reply reply;
  if (const char* fault = read_reply(split(text.substr(0, end)), reply))
    return Verdict::reject(fault, end + 2);
  out.push_back(std::move(reply));
  return Verdict::good(end + 2);
}

}  // namespace

char sum_of(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3FU) + 0x30U);
}

std::vector<Reply> ReplyFinder::on_bytes(Bytes bytes) {
  std::vector<Reply> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

}  // namespace odomcalib::drivers::scip
