// Boards with the firmware of ros_arduino_bridge and its descendants: lines of text ended by CR on a serial
// line. "e" is answered with "left right", "m l r" (counts per control interval) and "r" (zero the counts)
// with "OK", what is not understood with "Invalid Command". The board stops 2 s after the last "m". Source:
// open firmware ros_arduino_bridge, commands.h and ROSArduinoBridge.ino.
#pragma once

#include <array>
#include <deque>
#include <string_view>

#include "drivers/base/ros_arduino/settings.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

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

}  // namespace odomcalib::drivers
