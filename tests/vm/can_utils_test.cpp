// The tools that everybody has, can-utils, against our transports and logs.
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "drivers/can/candump.hpp"
#include "tests/unit/drivers/test_support.hpp"
#include "tests/vm/can_bench.hpp"

namespace odomcalib::vm {
namespace {

using drivers::CanFrame;
using test_support::Process;

const char* const kOutput = "/tmp/tool.log";

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<CanFrame> varied_frames() {
  std::vector<CanFrame> frames;
  for (unsigned i = 0; i < 30; ++i) {
    CanFrame frame;
    frame.extended = i % 3 == 1;
    frame.remote = i % 10 == 9;
    frame.id = frame.extended ? 0x12345600U + i : 0x100U + i;
    frame.length = static_cast<std::uint8_t>(i % 9);
    for (std::size_t k = 0; k < frame.length && !frame.remote; ++k)
      frame.data.at(k) = static_cast<std::uint8_t>(std::size_t{17} * i + k);
    frame.t = 1000.0 + 0.001 * i;
    frames.push_back(frame);
  }
  return frames;
}

class CanUtils : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::remove(kOutput); }
  static std::string tool(const std::string& name) { return "/usr/bin/" + name; }
  /// Sockets that receive everything on vcan0, from the kernel's list.
  static std::ptrdiff_t listeners() {
    const std::string list = text_of("/proc/net/can/rcvlist_all");
    const std::regex entry("\n +vcan0 ");
    return std::distance(std::sregex_iterator(list.begin(), list.end(), entry), {});
  }
  /// Our transport sends, candump writes its log, our reader reads it.
  static void expect_in_candump(drivers::CanTransport& transport) {
    const auto frames = varied_frames();
    const auto before = listeners();
    Process candump({tool("candump"), "-L", "-n", std::to_string(frames.size()), "vcan0"}, kOutput);
    ASSERT_TRUE(wait_until([&] { return listeners() > before; }, 5.0)) << "candump does not listen";
    for (const CanFrame& frame : frames) ASSERT_TRUE(transport.send(frame).ok());
    ASSERT_EQ(candump.wait(10.0), 0);
    const std::string log = text_of(kOutput);
    drivers::CandumpReader reader(log);
    for (const CanFrame& frame : frames) {
      const auto got = reader.next();
      ASSERT_TRUE(got.has_value()) << log;
      drivers::test::expect_same(*got, frame);
    }
  }
  static void expect_from_cansend(drivers::CanTransport& transport) {
    for (const char* text : {"123#DEADBEEF", "7FF#", "1ABCDEF0#0102030405060708", "701#R"}) {
      Process cansend({tool("cansend"), "vcan0", text}, kOutput);
      ASSERT_EQ(cansend.wait(10.0), 0);
      const auto got = frames_from(transport, 1, 3.0);
      ASSERT_EQ(got.size(), 1U) << text;
      const auto expected = drivers::parse_candump_line(std::string("(1.0) vcan0 ") + text);
      ASSERT_TRUE(expected.has_value());
      drivers::test::expect_same(got[0], *expected);
    }
  }

  Vcan bus_{"vcan0"};
};

TEST_F(CanUtils, cansend_reaches_a_kernel_socket) { expect_from_cansend(*opened("socketcan:vcan0")); }

TEST_F(CanUtils, candump_sees_what_a_kernel_socket_sends) {
  const auto transport = opened("socketcan:vcan0");
  expect_in_candump(*transport);
}

TEST_F(CanUtils, canplayer_replays_a_log_of_ours) {
  const auto transport = opened("socketcan:vcan0");
  const auto frames = varied_frames();
  std::ofstream log("/tmp/ours.candump");
  for (const CanFrame& frame : frames) log << drivers::candump_line(frame, "can0") << '\n';
  log.close();
  Process player({tool("canplayer"), "-I", "/tmp/ours.candump", "vcan0=can0"}, kOutput);
  const auto got = frames_from(*transport, frames.size(), 5.0);
  ASSERT_EQ(got.size(), frames.size()) << text_of(kOutput);
  for (std::size_t i = 0; i < frames.size(); ++i) drivers::test::expect_same(got[i], frames[i]);
}

// slcanpty is an adapter that somebody else wrote: Lawicel ASCII on a pseudo-terminal, vcan0 behind it.
class UserSpaceSlcan : public CanUtils {
 protected:
  void SetUp() override {
    CanUtils::SetUp();
    std::filesystem::remove("/tmp/slcanpty.log");
    adapter_ = std::make_unique<Process>(
        std::vector<std::string>{tool("stdbuf"), "-oL", tool("slcanpty"), "/dev/ptmx", "vcan0"},
        "/tmp/slcanpty.log");
    std::smatch found;
    ASSERT_TRUE(wait_until(
        [&] {
          const std::string said = text_of("/tmp/slcanpty.log");
          if (!std::regex_search(said, found, std::regex("/dev/pts/[0-9]+"))) return false;
          port_ = found.str();
          return true;
        },
        5.0))
        << text_of("/tmp/slcanpty.log");
    transport_ = opened("slcan:" + port_ + "?bitrate=500000");
    ASSERT_NE(transport_, nullptr);
  }
  void TearDown() override {
    transport_.reset();
    adapter_.reset();
  }

  std::unique_ptr<Process> adapter_;
  std::unique_ptr<drivers::CanTransport> transport_;
  std::string port_;
};

TEST_F(UserSpaceSlcan, cansend_arrives_through_a_foreign_adapter) { expect_from_cansend(*transport_); }

TEST_F(UserSpaceSlcan, a_foreign_adapter_puts_our_frames_on_the_bus) {
  const Peer peer("vcan0");
  for (const CanFrame& frame : varied_frames()) {
    ASSERT_TRUE(transport_->send(frame).ok());
    const auto got = peer.receive(3.0);
    ASSERT_TRUE(got.has_value()) << std::hex << frame.id;
    EXPECT_EQ(got->can_id & CAN_EFF_MASK, frame.id);
    EXPECT_EQ((got->can_id & CAN_RTR_FLAG) != 0, frame.remote);
    EXPECT_EQ(got->len, frame.remote ? 0 : frame.length);  // slcanpty forgets the length of remote frames
  }
}

TEST(Slcand, attaches_an_adapter_that_our_kernel_socket_then_uses) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_EQ(grantpt(master) + unlockpt(master), 0);
  const std::string port = ptsname(master);
  Process slcand({"/usr/bin/slcand", "-F", "-o", "-c", "-s6", port.substr(5), "slcan7"}, kOutput);
  ASSERT_TRUE(wait_until([] { return ip("link show slcan7") == 0; }, 5.0)) << text_of(kOutput);
  ASSERT_EQ(ip("link set slcan7 up"), 0) << text_of("/tmp/ip.log");
  const auto transport = opened("socketcan:slcan7");
  ASSERT_NE(transport, nullptr);
  const std::string line = "t18121122\r";
  ASSERT_EQ(write(master, line.data(), line.size()), static_cast<ssize_t>(line.size()));
  const auto got = frames_from(*transport, 1);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].data[1], 0x22);
  CanFrame frame;
  frame.id = 0x77;
  ASSERT_TRUE(transport->send(frame).ok());
  std::string heard;
  EXPECT_TRUE(wait_until(
      [&] {
        std::array<char, 256> bytes{};
        const ssize_t count = read(master, bytes.data(), bytes.size());
        if (count > 0) heard.append(bytes.data(), static_cast<std::size_t>(count));
        return heard.find("t0770\r") != std::string::npos;
      },
      2.0))
      << heard;
  EXPECT_NE(heard.find("S6\r"), std::string::npos) << heard;
  EXPECT_NE(heard.find("O\r"), std::string::npos) << heard;
  close(master);
}

}  // namespace
}  // namespace odomcalib::vm
