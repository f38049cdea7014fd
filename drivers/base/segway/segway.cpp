// Segway RMP: CAN, 11 bit, big-endian words. Read only: no command time-out of the device is documented, so
// it is never enabled. Source: Segway RMP interface guide.
#include <algorithm>

#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

class Segway final : public SpeedProtocol {
 public:
  explicit Segway(const Profile& /*profile*/) {}

  [[nodiscard]] Wire wire() const override { return Wire::can; }
  void on_frame(const CanFrame& frame) override;
  void greet(double /*now*/) override {}
  void command(double /*left_rad_s*/, double /*right_rad_s*/) override {}
  [[nodiscard]] Counters counters() const override;

  static const std::vector<WireMessage>& messages();

 private:
  std::uint64_t frames_in_ = 0, frames_used_ = 0, bad_frames_ = 0, other_frames_ = 0;
};

constexpr std::uint32_t kPositions = 0x403;
constexpr double kCountsPerMetrePerSecond = 332.0;  // RMP200

/// 32 bits as two big-endian words, the low word first.
std::int64_t position(ByteReader& reader) {
  const std::uint64_t low = reader.big_endian(2);
  return static_cast<std::int64_t>(reader.big_endian(2) << 16 | low);
}

}  // namespace

const std::vector<WireMessage>& Segway::messages() {
  using enum WireType;
  static const std::vector<WireMessage> table = {
      {0x400, "marker", {}},
      {0x401,
       "attitude",
       {{"pitch", 0, i16}, {"pitch_rate", 2, i16}, {"roll", 4, i16}, {"roll_rate", 6, i16}}},
      {0x402,
       "speeds",
       {{"left_m_s", 0, i16, kCountsPerMetrePerSecond},
        {"right_m_s", 2, i16, kCountsPerMetrePerSecond},
        {"yaw_rate", 4, i16},
        {"counter", 6, u16}}},
      {0x404, "travel", {{"forward", 0, i32}, {"turn", 4, i32}}},
      {0x405, "torques", {{"left", 0, i16}, {"right", 2, i16}}},
      {0x413,
       "motion_command",
       {{"speed_m_s", 0, i16, kCountsPerMetrePerSecond},
        {"yaw", 2, i16},
        {"configuration", 4, u16},
        {"parameter", 6, u16}}},
  };
  return table;
}

void Segway::on_frame(const CanFrame& frame) {
  ++frames_in_;
  const Bytes data = Bytes(frame.data).first(std::min<std::size_t>(frame.length, 8));
  const bool plain = !frame.extended && !frame.remote && !frame.error;
  if (plain && frame.id == kPositions) {
    ByteReader reader(data);
    const std::int64_t left = position(reader);
    const std::int64_t right = position(reader);
    ++(reader.ok() ? frames_used_ : bad_frames_);
    if (!reader.ok()) return;
    count(Side::left, frame.t, left);
    return count(Side::right, frame.t, right);
  }
  const WireMessage* layout = plain ? find_message(messages(), frame.id) : nullptr;
  if (layout == nullptr) {
    ++other_frames_;
    return;
  }
  auto message = read_message(*layout, data, Endian::big, frame.t);
  ++(message ? frames_used_ : bad_frames_);
  if (message) report(std::move(*message));
}

Counters Segway::counters() const {
  return {{"frames_in", frames_in_},
          {"frames_used", frames_used_},
          {"bad_frames", bad_frames_},
          {"other_frames", other_frames_}};
}

std::unique_ptr<SpeedProtocol> make_segway(const Profile& profile) {
  return std::make_unique<Segway>(profile);
}

}  // namespace odomcalib::drivers
