#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <thread>

#include "drivers/can/transport.hpp"
#include "drivers/serial/port.hpp"
#include "tests/unit/drivers/ready_can.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::port_test {
namespace {

/// The device's end of a pseudo-terminal.
class Pty {
 public:
  Pty() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_EQ(grantpt(master_), 0);
    EXPECT_EQ(unlockpt(master_), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(master_, name.data(), name.size()), 0);
    path = name.data();
  }
  ~Pty() { unplug(); }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  void unplug() {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }
  void say(const std::string& text) const {
    EXPECT_EQ(::write(master_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Text that arrives until nothing comes for so long.
  [[nodiscard]] std::string hear(int quiet_ms = 50) const {
    std::string out;
    pollfd state{master_, POLLIN, 0};
    std::array<char, 256> chunk{};
    while (poll(&state, 1, quiet_ms) > 0) {
      const ssize_t n = ::read(master_, chunk.data(), chunk.size());
      if (n <= 0) break;
      out.append(chunk.data(), static_cast<std::size_t>(n));
    }
    return out;
  }

  std::string path;

 private:
  int master_;
};

Result<std::vector<std::uint8_t>> read_soon(ByteStream& port) {
  pollfd state{port.fd(), POLLIN, 0};
  poll(&state, 1, 1000);
  return port.read();
}

TEST(DeviceString, is_taken_apart) {
  const auto device = value_of(parse_device("slcan:/dev/ttyACM0?bitrate=250000&baud=1000000"));
  EXPECT_EQ(device.scheme, "slcan");
  EXPECT_EQ(device.path, "/dev/ttyACM0");
  EXPECT_EQ(device.option("bitrate", ""), "250000");
  EXPECT_EQ(device.option("missing", "7"), "7");
  EXPECT_TRUE(parse_device("tcp:192.168.0.10:2112").ok());
}

TEST(DeviceString, that_is_wrong_is_refused_with_an_example) {
  for (const std::string text :
       {"", "can0", "usb:/dev/x", "serial:", "serial:?baud=1", "serial:/dev/x?", "serial:/dev/x?baud",
        "serial:/dev/x?=1", "serial:/dev/x?baud=", "serial:/dev/x?baud=1&baud=2", ":x"}) {
    const auto device = parse_device(text);
    ASSERT_FALSE(device.ok()) << text;
    EXPECT_EQ(device.error().code, ErrorCode::usage);
    EXPECT_NE(device.error().text().find("serial:/dev/ttyUSB0"), std::string::npos);
  }
}

TEST(DeviceString, has_no_option_that_nobody_looks_at) {
  for (const auto& [text, said] : {std::pair("slcan:/dev/x?bit_rate=250000", "takes bitrate, baud"),
                                   {"socketcan:can0?bitrate=250000", "ip link set"},
                                   {"serial:/dev/x?boud=115200", "takes baud"},
                                   {"tcp:host:2112?baud=1", "tcp:HOST:PORT"}}) {
    const auto device = parse_device(text);
    ASSERT_FALSE(device.ok()) << text;
    EXPECT_EQ(device.error().code, ErrorCode::usage);
    EXPECT_NE(device.error().what.find("unknown option"), std::string::npos);
    EXPECT_NE(device.error().remedy.find(said), std::string::npos) << device.error().remedy;
  }
}

TEST(Serial, carries_every_byte_value_unchanged_in_both_directions) {
  for (const unsigned baud : {115200U, 230400U, 256000U}) {
    Pty pty;
    auto port = value_of(open_serial(pty.path, baud));
    std::string all;
    for (int i = 0; i < 256; ++i) all += static_cast<char>(i);
    pty.say(all);
    test::ByteString got;
    while (got.size() < all.size()) {
      const auto more = value_of(read_soon(*port));
      ASSERT_FALSE(more.empty());
      got.insert(got.end(), more.begin(), more.end());
    }
    EXPECT_EQ(got, test::bytes_of(all));
    ASSERT_TRUE(port->write(test::bytes_of(all)).ok());
    EXPECT_EQ(pty.hear(), all);
  }
}

TEST(Serial, silence_is_empty_and_unplugging_is_an_error) {
  Pty pty;
  auto port = value_of(open_serial(pty.path, 115200));
  const auto nothing = value_of(port->read());
  EXPECT_TRUE(nothing.empty());
  pty.unplug();
  const auto gone = read_soon(*port);
  ASSERT_FALSE(gone.ok());
  EXPECT_EQ(gone.error().code, ErrorCode::device);
  EXPECT_FALSE(port->write(test::bytes_of("x")).ok());
}

TEST(Serial, a_port_in_use_or_absent_is_refused_and_can_be_opened_again_later) {
  Pty pty;
  auto first = value_of(open_serial(pty.path, 115200));
  EXPECT_FALSE(open_serial(pty.path, 115200).ok());
  first.reset();
  EXPECT_TRUE(open_serial(pty.path, 115200).ok());
  EXPECT_NE(open_serial("/dev/does-not-exist", 115200).error().text().find("by-id"), std::string::npos);
  EXPECT_EQ(open_serial(pty.path, 0).error().code, ErrorCode::usage);
  EXPECT_FALSE(open_serial("/dev/null", 115200).ok());
}

std::ptrdiff_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

/// The daemon tries again and again.
TEST(Serial, what_is_no_serial_port_is_refused_and_leaves_no_descriptor_open) {
  const auto before = open_descriptors();
  for (int k = 0; k < 10; ++k) {
    const auto port = open_serial("/dev/null", 115200);
    ASSERT_FALSE(port.ok());
    EXPECT_THAT(port.error().text(), ::testing::HasSubstr("cannot be set up as a serial port"));
  }
  EXPECT_EQ(open_descriptors(), before);
}

TEST(Serial, a_device_that_takes_nothing_does_not_block) {
  Pty pty;
  auto port = value_of(open_serial(pty.path, 115200));
  const test::ByteString block(4096, 'x');
  bool full = false;
  for (int i = 0; i < 100 && !full; ++i) full = !port->write(block).ok();
  EXPECT_TRUE(full);
}

// Half a command glued to the next one would be another command.
TEST(Serial, sends_whole_lines_or_none_when_the_buffer_was_full) {
  Pty pty;
  auto port = open_serial(pty.path, 115200);
  ASSERT_TRUE(port.ok());
  const std::string line = std::string(4999, 'x') + "\r";  // more than a port takes at once: it is cut
  const test::ByteString bytes(line.begin(), line.end());
  std::size_t taken = 0;
  while (taken < 10'000 && port.value()->write(bytes).ok()) ++taken;
  ASSERT_LT(taken, 10'000U) << "never full";
  std::string heard = pty.hear();
  ASSERT_TRUE(port.value()->write(bytes).ok());
  heard += pty.hear();
  ++taken;
  ASSERT_EQ(heard.size(), taken * line.size());
  for (std::size_t i = 0; i < taken; ++i) ASSERT_EQ(heard.substr(i * line.size(), line.size()), line) << i;
}

/// Plays the adapter: answers each set-up command with the given text.
void play_adapter(const Pty& pty, const std::string& to_rate, const std::string& to_open,
                  std::string& heard) {
  for (int i = 0; i < 40 && heard.find("O\r") == std::string::npos; ++i) {
    const std::size_t before = heard.size();
    heard += pty.hear(20);
    if (heard.find("S6\r", before > 2 ? before - 2 : 0) != std::string::npos) pty.say(to_rate);
    if (heard.find("O\r") != std::string::npos) pty.say(to_open);
  }
}

/// Opens the port of an adapter that answers so.
Result<std::unique_ptr<CanTransport>> open_slcan(const Pty& pty, const std::string& options,
                                                 const std::string& to_rate, const std::string& to_open) {
  std::string heard;
  std::thread adapter([&] { play_adapter(pty, to_rate, to_open, heard); });
  auto can = test::open_ready_can("slcan:" + pty.path + options);
  adapter.join();
  return can;
}

std::vector<CanFrame> frames_soon(CanTransport& can) {
  pollfd state{can.fd(), POLLIN, 0};
  EXPECT_EQ(poll(&state, 1, 1000), 1);
  return value_of(can.receive(5.0));
}

TEST(SlcanPort, sets_up_the_adapter_and_passes_frames) {
  Pty pty;
  std::string heard;
  std::thread adapter([&] { play_adapter(pty, "\r", "\r", heard); });
  auto can = test::open_ready_can("slcan:" + pty.path + "?bitrate=500000");
  adapter.join();
  ASSERT_TRUE(can.ok()) << can.error().text();
  EXPECT_EQ(heard, "\r\r\rC\rS6\rO\r");
  pty.say("t1232AABB\r");
  const auto frames = frames_soon(*can.value());
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 0x123U);
  EXPECT_EQ(frames[0].t, 5.0);  // without a baud rate no transfer time is known
  CanFrame frame;
  frame.id = 0x601;
  frame.length = 1;
  frame.data[0] = 0x40;
  EXPECT_TRUE(can.value()->send(frame).ok());
  EXPECT_EQ(pty.hear(), "t601140\r");
}

TEST(SlcanPort, frames_of_one_read_are_dated_by_what_came_after_them) {
  Pty pty;
  const auto can = value_of(open_slcan(pty, "?bitrate=500000&baud=115200", "\r", "\r"));
  pty.say("t1232AABB\rt1240\r");  // 10 and 6 characters of 10 bits each
  const auto frames = frames_soon(*can);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_NEAR(frames[0].t, 5.0 - 160.0 / 115200.0, 1e-9);
  EXPECT_NEAR(frames[1].t, 5.0 - 60.0 / 115200.0, 1e-9);
}

TEST(SlcanPort, an_adapter_that_refuses_is_named_as_such) {
  Pty refusing;
  const auto can = open_slcan(refusing, "", "\r", "\a");
  ASSERT_FALSE(can.ok());
  EXPECT_NE(can.error().text().find("does not open"), std::string::npos);
  EXPECT_EQ(open_can("slcan:" + refusing.path + "?bitrate=333").error().code, ErrorCode::usage);
  EXPECT_EQ(open_can("serial:/dev/null").error().code, ErrorCode::usage);
}

TEST(SlcanPort, an_adapter_that_acknowledges_nothing_is_used_and_told_until_it_passes_frames) {
  Pty silent;
  const auto can = value_of(test::open_ready_can("slcan:" + silent.path));
  EXPECT_NE(can->note().find("acknowledges nothing"), std::string::npos);
  EXPECT_EQ(can->counters().at("unacknowledged"), 1U);
  silent.say("t1232AABB\r");
  EXPECT_EQ(frames_soon(*can).size(), 1U);
  EXPECT_EQ(can->note(), "");
}

// Opening and each look at it return at once, whatever the adapter does: the loop that steers waits for
// nothing.
TEST(SlcanPort, an_adapter_is_set_up_in_steps_and_nobody_waits_for_it) {
  Pty silent;
  const auto begin = std::chrono::steady_clock::now();
  const auto can = value_of(open_can("slcan:" + silent.path));
  double opened = 0.0;
  for (double now = 100.0; now < 110.0 && opened == 0.0; now += 0.001)
    if (value_of(can->ready(now))) opened = now - 100.0;
  EXPECT_NEAR(opened, 0.6, 0.01) << "what was there before, and two commands without an answer";
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(200)) << "it was waited for";
  EXPECT_EQ(silent.hear(), "\r\r\rC\rS6\rO\r");
  EXPECT_EQ(can->counters().at("unacknowledged"), 1U);
}

TEST(SlcanPort, frames_that_come_with_the_last_answer_are_kept) {
  Pty pty;
  const auto can = value_of(open_can("slcan:" + pty.path));
  double now = 0.0;
  const auto said = [&](const std::string& command, const std::string& answer) {
    std::string heard;
    for (const double end = now + 1.0; now < end && heard.find(command) == std::string::npos; now += 0.01) {
      EXPECT_FALSE(value_of(can->ready(now)));
      heard += pty.hear(5);
    }
    pty.say(answer);
  };
  said("S6\r", "\r");
  said("O\r", "\rt1232AABB\r");
  while (now < 10.0 && !value_of(can->ready(now))) now += 0.01;
  const auto frames = value_of(can->receive(now));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].id, 0x123U);
}

TEST(SlcanPort, an_adapter_that_leaves_while_it_is_set_up_is_told) {
  auto pty = std::make_unique<Pty>();
  const auto can = value_of(open_can("slcan:" + pty->path));
  ASSERT_FALSE(value_of(can->ready(0.0)));
  pty.reset();
  EXPECT_FALSE(can->ready(0.01).ok());
}

TEST(SlcanPort, an_adapter_that_acknowledges_needs_no_note) {
  Pty pty;
  const auto can = value_of(open_slcan(pty, "", "\r\n", "\r\n"));
  EXPECT_EQ(can->note(), "");
  EXPECT_EQ(can->counters().at("unacknowledged"), 0U);
}

TEST(SocketCan, what_is_missing_is_named_with_a_command_that_helps) {
  const auto can = open_can("socketcan:nocan7");
  ASSERT_FALSE(can.ok());
  EXPECT_EQ(can.error().code, ErrorCode::device);
  EXPECT_TRUE(can.error().text().find("AF_CAN") != std::string::npos ||
              can.error().text().find("no such network interface") != std::string::npos);
  EXPECT_FALSE(can.error().remedy.empty());
}

}  // namespace
}  // namespace odomcalib::drivers::port_test
