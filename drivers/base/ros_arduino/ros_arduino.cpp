// Boards with the firmware of ros_arduino_bridge and its descendants: lines of text ended by CR on a serial
// line. "e" is answered with "left right", "m l r" (counts per control interval) and "r" (zero the counts)
// with "OK", what is not understood with "Invalid Command". The board stops 2 s after the last "m". Source:
// open firmware ros_arduino_bridge, commands.h and ROSArduinoBridge.ino.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <deque>
#include <numbers>
#include <string_view>

#include "drivers/base/ros_arduino/settings.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

class RosArduino final : public SpeedProtocol {
 public:
  explicit RosArduino(const Profile& profile) : profile_(profile) {}

  [[nodiscard]] Wire wire() const override { return Wire::serial; }
  void on_connected(std::optional<unsigned> baud) override;
  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  void greet(double /*now*/) override {}
  void ask(double now) override;
  void command(double left_rad_s, double right_rad_s) override;
  void stop() override;
  [[nodiscard]] Counters counters() const override;

 private:
  static constexpr std::size_t kLongestLine = ros_arduino::kLongestLine;
  struct Question {
    enum class Kind { counts, speed, stop } kind;
    double sent_at;
  };

  [[nodiscard]] std::optional<Question> answered(std::string_view line, double t);
  void on_line(double t);
  void on_counts(std::string_view line, double t);
  void refuse(std::uint64_t& counter);
  void send_line(const std::string& line, Question::Kind kind, double now);
  [[nodiscard]] double transfer_s(std::size_t bytes) const;

  const Profile profile_;
  std::optional<unsigned> baud_;
  std::array<char, kLongestLine> line_{};
  std::size_t used_ = 0;
  bool overlong_ = false;
  bool asked_ = false;            ///< false: this is a recording, answers stand for themselves
  std::deque<Question> waiting_;  ///< answers come in the order of the questions
  std::optional<std::array<long, 2>> wanted_;
  double now_ = 0.0, ask_due_ = 0.0;
  std::uint64_t bytes_in_ = 0, good_ = 0, skipped_ = 0;
  std::uint64_t bad_line_ = 0, long_line_ = 0, unasked_ = 0, invalid_ = 0, no_answer_ = 0;
};

using namespace ros_arduino;
constexpr std::string_view kAccepted = "OK", kNotUnderstood = "Invalid Command";

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// One whole number at the beginning of text, which is cut off it together with one blank.
std::optional<std::int64_t> cut_number(std::string_view& text) {
  std::int32_t value = 0;  // `long` on the board
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.empty() && text[0] == ' ') text.remove_prefix(1);
  return value;
}

bool is_counts(std::string_view line) { return cut_number(line) && cut_number(line) && line.empty(); }

}  // namespace

void RosArduino::on_connected(std::optional<unsigned> baud) {
  baud_ = baud;
  skipped_ += used_;
  used_ = 0;
  overlong_ = false;
  waiting_.clear();
}

double RosArduino::transfer_s(std::size_t bytes) const {
  return baud_ ? 10.0 * static_cast<double>(bytes) / *baud_ : 0.0;
}

void RosArduino::send_line(const std::string& line, Question::Kind kind, double now) {
  send(bytes_of(line + "\r"));
  waiting_.push_back({kind, now});
  asked_ = true;
}

/// One question at a time, but for stops: then an answer cannot be taken for another one's.
void RosArduino::ask(double now) {
  now_ = now;
  if (!waiting_.empty() && now - waiting_.front().sent_at >= kAnswer_s) {
    ++no_answer_;
    waiting_.clear();
  }
  const auto is_stop = [](const Question& question) { return question.kind == Question::Kind::stop; };
  if (!std::all_of(waiting_.begin(), waiting_.end(), is_stop)) return;
  if (wanted_) {
    send_line("m " + std::to_string((*wanted_)[0]) + " " + std::to_string((*wanted_)[1]),
              Question::Kind::speed, now);
    wanted_.reset();
  } else if (now >= ask_due_) {
    send_line("e", Question::Kind::counts, now);
    ask_due_ = now + kAsk_s;
  }
}

void RosArduino::command(double left_rad_s, double right_rad_s) {
  const double counts = profile_.ticks_per_rev * profile_.interval_s / (2.0 * std::numbers::pi);
  wanted_ = {std::lround(left_rad_s * counts), std::lround(right_rad_s * counts)};
}

/// A stop waits for no answer, which may have been lost (M14); its own comes after those that are due.
void RosArduino::stop() {
  wanted_.reset();
  send_line("m 0 0", Question::Kind::stop, now_);
}

void RosArduino::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  now_ = now;
  bytes_in_ += bytes.size();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char c = static_cast<char>(bytes[i]);
    if (c == '\n') {
      on_line(now - transfer_s(bytes.size() - 1 - i));
    } else if (overlong_) {
      ++skipped_;
    } else if (used_ == kLongestLine) {
      ++long_line_;
      skipped_ += used_ + 1;
      used_ = 0;
      overlong_ = true;
    } else {
      line_[used_++] = c;
    }
  }
}

void RosArduino::refuse(std::uint64_t& counter) {
  ++counter;
  skipped_ += used_ + 1;
  used_ = 0;
}

/// The question that this line answers. Where it fits a later one and not the first, the answers before it
/// were lost. A whole answer that fits none has come before, or late; one that is garbled is the next one's.
std::optional<RosArduino::Question> RosArduino::answered(std::string_view line, double t) {
  if (!asked_) return Question{line == kAccepted ? Question::Kind::speed : Question::Kind::counts, t};
  const auto fits = [&](const Question& question) {
    return (question.kind == Question::Kind::counts) != (line == kAccepted);
  };
  auto found = std::find_if(waiting_.begin(), waiting_.end(), fits);
  if (found == waiting_.end() && (line == kAccepted || is_counts(line))) return std::nullopt;
  if (found == waiting_.end() || line == kNotUnderstood) found = waiting_.begin();
  const Question question = *found;
  no_answer_ += static_cast<std::uint64_t>(found - waiting_.begin());
  waiting_.erase(waiting_.begin(), found + 1);
  return question;
}

/// The board prints "\r\n" at the end of a line.
void RosArduino::on_line(double t) {
  if (overlong_) {
    overlong_ = false;
    ++skipped_;
    return;
  }
  std::string_view line(line_.data(), used_);
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  if (waiting_.empty() && asked_) return refuse(unasked_);
  const auto answers = answered(line, t);
  if (!answers) return refuse(unasked_);
  const Question& question = *answers;
  if (line == kNotUnderstood) return refuse(invalid_);
  if (question.kind != Question::Kind::counts && line != kAccepted) return refuse(bad_line_);
  if (question.kind == Question::Kind::counts) {
    const auto before = bad_line_;
    // The board counts between the end of the question and the beginning of the answer.
    const double earliest = question.sent_at + transfer_s(2);
    const double latest = t - transfer_s(used_ + 1);
    on_counts(line, 0.5 * (earliest + std::max(earliest, latest)));
    if (bad_line_ != before) return;
  }
  good_ += used_ + 1;
  used_ = 0;
}

void RosArduino::on_counts(std::string_view line, double t) {
  const auto left = cut_number(line);
  const auto right = left ? cut_number(line) : std::nullopt;
  if (!right || !line.empty()) return refuse(bad_line_);
  count(Side::left, t, *left);
  count(Side::right, t, *right);
}

Counters RosArduino::counters() const {
  return {{"bytes_in", bytes_in_},    {"good", good_},
          {"skipped", skipped_},      {"buffered", used_},
          {"bad_line", bad_line_},    {"line_too_long", long_line_},
          {"unasked_line", unasked_}, {"invalid_command", invalid_},
          {"no_answer", no_answer_}};
}

std::unique_ptr<SpeedProtocol> make_ros_arduino(const Profile& profile) {
  return std::make_unique<RosArduino>(profile);
}

}  // namespace odomcalib::drivers
