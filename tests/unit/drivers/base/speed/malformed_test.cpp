// Damaged input at every protocol: nothing crashes, every byte is accounted for, nothing wrong is taken for
// right.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/base/arcos/packet.hpp"
#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/base/vesc/buffer.hpp"
#include "tests/sim/wires/serial_devices.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::malformed_test {
namespace {

using test::ByteString;
using test::Random;

constexpr int kCases = 1500;

Profile profile_of(const std::string& name) {
  auto profile = read_profile("drivers/base/profiles/" + name + ".toml");
  EXPECT_TRUE(profile.ok()) << profile.error().text();
  return std::move(profile).value();
}

std::unique_ptr<SpeedProtocol> protocol_of(const std::string& name) {
  return make_speed_protocol(profile_of(name)).value();
}

/// Identifiers that the protocol listens to, so that damage meets its parsers.
std::uint32_t likely_id(const std::string& protocol, Random& random) {
  const std::uint32_t any = random();
  if (protocol == "agilex")
    return std::array<std::uint32_t, 6>{0x211, 0x221, 0x251, 0x252, 0x261, 0x311}[any % 6];
  if (protocol == "segway") return 0x400 + any % 8;
  if (protocol == "odrive") return (1 + any % 2) << 5 | (any >> 8) % 32;
  const std::uint32_t command = std::array<std::uint32_t, 9>{5, 6, 7, 8, 9, 14, 16, 27, 3}[any % 9];
  return command << 8 | (command < 9 ? 0x7F : 1 + (any >> 8) % 2);
}

class CanProtocols : public testing::TestWithParam<const char*> {};

TEST_P(CanProtocols, take_any_frame) {
  auto random = test::seeded(31);
  const std::string name = GetParam();
  const auto protocol = protocol_of(name);
  for (int i = 0; i < 20 * kCases; ++i) {
    CanFrame frame;
    frame.t = 0.001 * i;
    frame.extended = name == "vesc" ? random() % 8 != 0 : random() % 8 == 0;
    frame.remote = random() % 16 == 0;
    frame.error = random() % 16 == 0;
    frame.id = random() % 4 == 0 ? random() & 0x1FFFFFFF : likely_id(name, random);
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (auto& byte : frame.data) byte = test::random_byte(random);
    protocol->on_frame(frame);
    for (const SideCount& count : protocol->take_counts()) ASSERT_EQ(count.t, frame.t);
    for (const DeviceMessage& message : protocol->take_messages())
      for (const MessageField& field : message.fields) ASSERT_TRUE(std::isfinite(field.number)) << field.name;
  }
  const Counters counters = protocol->counters();
  EXPECT_EQ(counters.at("frames_in"),
            counters.at("frames_used") + counters.at("bad_frames") + counters.at("other_frames"));
  EXPECT_GT(counters.at("frames_used"), 100U);
  EXPECT_GT(counters.at("bad_frames"), 100U);
}

INSTANTIATE_TEST_SUITE_P(All, CanProtocols, testing::Values("agilex", "odrive", "segway", "vesc"));

TEST(CanProtocolLengths, every_message_cut_at_every_byte_is_refused) {
  for (const char* name : {"agilex", "odrive", "vesc"}) {
    const auto protocol = protocol_of(name);
    const bool vesc = std::string(name) == "vesc", odrive = std::string(name) == "odrive";
    const std::uint32_t id = vesc ? 27U << 8 | 1U : odrive ? 1U << 5 | 0x0AU : 0x311U;
    for (std::uint8_t length = 0; length <= 8; ++length) {
      CanFrame frame;
      frame.extended = vesc;
      frame.id = id;
      frame.length = length;
      const auto before = protocol->counters().at("bad_frames");
      protocol->on_frame(frame);
      const bool enough = length >= (vesc ? 6 : 8);
      EXPECT_EQ(protocol->counters().at("bad_frames") - before, enough ? 0U : 1U)
          << name << " " << int{length};
    }
  }
}

class SerialProtocols : public testing::TestWithParam<const char*> {};

/// Bytes that a device sends in two seconds.
ByteString session(const std::string& name) {
  std::unique_ptr<sim::SerialDevice> device;
  std::string out;
  if (name == "arcos") {
    device = std::make_unique<sim::PioneerBase>();
    for (const auto& command : {arcos::command(0), arcos::command(1), arcos::command(2), arcos::command(1, 1),
                                arcos::command(18), arcos::command(19, 2)})
      device->receive({command.begin(), command.end()}, 1.0);
  } else {
    device = std::make_unique<sim::ArduinoBoard>();
  }
  for (double t = 1.0; t < 3.0; t += 0.001) {
    if (name != "arcos") device->receive("e\r", t);
    out += device->advance(t);
  }
  return {out.begin(), out.end()};
}

void damage(ByteString& bytes, Random& random) {
  for (unsigned n = 1 + random() % 6; n > 0 && !bytes.empty(); --n) {
    const std::size_t at = random() % bytes.size();
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (random() % 5) {
      case 0:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << random() % 8));
        break;
      case 1:
        bytes.erase(place);
        break;
      case 2:
        bytes.insert(place, random() % 20, test::random_byte(random));
        break;
      case 3:
        bytes.resize(at);
        break;
      default:
        for (const int head : {0xFB, 0xFA})
          bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::uint8_t>(head));
    }
  }
}

TEST_P(SerialProtocols, account_for_every_damaged_byte) {
  auto random = test::seeded(32);
  const ByteString good = session(GetParam());
  ASSERT_GT(good.size(), 300U);
  const auto protocol = protocol_of(GetParam());
  for (int i = 0; i < kCases; ++i) {
    const std::size_t from = random() % (good.size() - 300);
    ByteString bytes(good.begin() + static_cast<std::ptrdiff_t>(from),
                     good.begin() + static_cast<std::ptrdiff_t>(from + 300));
    damage(bytes, random);
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t n = std::min<std::size_t>(1 + random() % 64, bytes.size() - at);
      protocol->on_bytes(std::span(bytes).subspan(at, n), i);
      at += n;
      test::expect_accounted(protocol->counters());
    }
    (void)protocol->take_counts();
    (void)protocol->take_messages();
    (void)protocol->take_bytes();
  }
  EXPECT_GT(protocol->counters().at("good"), 0U);
  EXPECT_GT(protocol->counters().at("skipped"), 0U);
  EXPECT_LT(protocol->counters().at("buffered"), 600U);
}

TEST_P(SerialProtocols, do_not_care_how_the_bytes_are_cut) {
  const ByteString good = session(GetParam());
  std::vector<std::vector<std::int64_t>> all;
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, good.size()}) {
    const auto protocol = protocol_of(GetParam());
    std::vector<std::int64_t> counts;
    for (std::size_t at = 0; at < good.size(); at += piece) {
      protocol->on_bytes(std::span(good).subspan(at, std::min(piece, good.size() - at)), 1.0);
      for (const SideCount& count : protocol->take_counts()) counts.push_back(count.raw);
    }
    all.push_back(counts);
    EXPECT_GT(counts.size(), 20U);
  }
  EXPECT_EQ(all[0], all[1]);
  EXPECT_EQ(all[0], all[2]);
}

INSTANTIATE_TEST_SUITE_P(All, SerialProtocols, testing::Values("arcos", "ros_arduino"));

TEST(ArcosPacket, no_flipped_bit_passes_for_a_packet) {
  const ByteString good = arcos::framed(ByteString{0x90, 1, 2, 3, 4, 5, 6, 7, 8});
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    ByteString bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
    arcos::PacketFinder finder;
    EXPECT_TRUE(finder.on_bytes(bad).empty()) << bit;
    EXPECT_EQ(finder.on_bytes(ByteString(300, 0)).size(), 0U);
    test::expect_accounted(finder.counters());
  }
  arcos::PacketFinder finder;
  EXPECT_EQ(finder.on_bytes(good).size(), 1U);
}

TEST(VescBuffer, only_whole_packets_with_the_right_checksum_pass) {
  auto random = test::seeded(33);
  int passed = 0;
  for (int i = 0; i < kCases; ++i) {
    ByteString packet(1 + random() % 400);
    for (auto& byte : packet) byte = test::random_byte(random);
    auto frames = vesc::pieces_of(packet, 0x7F, 1);
    const bool hurt = i % 2 == 0;
    if (hurt) {
      CanFrame& frame = frames[random() % frames.size()];
      const std::size_t head = frame.id >> 8 == 5 ? 1 : 2;  // offset, or sender and flag
      const std::size_t at = head + random() % (frame.length - head);
      frame.data[at] = static_cast<std::uint8_t>(frame.data[at] ^ (1U << random() % 8));
    }
    vesc::ReceiveBuffer buffer;
    std::optional<ByteString> got;
    for (const CanFrame& frame : frames) {
      const Bytes data = Bytes(frame.data).first(frame.length);
      if (frame.id >> 8 == 7)
        got = buffer.on_end(data);
      else
        buffer.on_piece(data, frame.id >> 8 == 6);
    }
    if (got) {
      EXPECT_EQ(*got, packet);
    }
    ASSERT_TRUE(hurt || got);
    if (hurt && got) ++passed;
  }
  EXPECT_EQ(passed, 0);
}

TEST(VescBuffer, lengths_and_offsets_beyond_its_end_are_refused) {
  vesc::ReceiveBuffer buffer;
  buffer.on_piece(ByteString{0xFF, 0xFF, 1, 2, 3}, true);
  buffer.on_piece(ByteString{0x03, 0xFF, 1, 2}, true);
  buffer.on_piece({}, false);
  buffer.on_piece(ByteString{7}, false);
  for (const unsigned length : {0U, 1U, 1024U, 1025U, 65535U})
    EXPECT_FALSE(buffer.on_end(
        ByteString{1, 0, static_cast<std::uint8_t>(length >> 8), static_cast<std::uint8_t>(length), 0, 0}));
  EXPECT_FALSE(buffer.on_end(ByteString{1, 0, 0}));
  EXPECT_EQ(buffer.rejected(), 10U);
}

}  // namespace
}  // namespace odomcalib::drivers::malformed_test
