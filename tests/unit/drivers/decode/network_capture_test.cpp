// TCP streams out of network captures: in order, without repetitions, with every gap told.
#include "drivers/decode/network_capture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "drivers/decode/decode.hpp"
#include "tests/unit/drivers/decoded.hpp"
#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::network_capture_test {
namespace {

using test::ByteString;
using test::lines_of;

std::string big(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i));
  return out;
}

std::string little(std::uint64_t value, int bytes) {
  std::string out = big(value, bytes);
  std::reverse(out.begin(), out.end());
  return out;
}

enum class Net { ethernet, vlan, ipv6 };

struct Packet {
  unsigned from_port = 2112, to_port = 40'000;
  std::uint32_t sequence = 0, acknowledged = 0;
  unsigned flags = 0x10;
  std::string data;
  unsigned host = 1;  // last byte of the sender's address
};

std::string ip_packet(const Packet& packet, Net net) {
  const std::string tcp = big(packet.from_port, 2) + big(packet.to_port, 2) + big(packet.sequence, 4) +
                          big(packet.acknowledged, 4) + "\x50" + static_cast<char>(packet.flags) +
                          std::string("\x10\x00\x00\x00\x00\x00", 6) + packet.data;
  const std::string from = "\xC0\xA8" + std::string(1, '\0') + static_cast<char>(packet.host);
  const std::string to("\xC0\xA8\x00\x09", 4);
  if (net == Net::ipv6)
    return std::string("\x60\x00\x00\x00", 4) + big(tcp.size(), 2) + "\x06\x40" + std::string(12, '\xFE') +
           from + std::string(12, '\xFE') + to + tcp;
  return std::string("\x45\x00", 2) + big(20 + tcp.size(), 2) +
         std::string("\x00\x00\x40\x00\x40\x06\x00\x00", 8) + from + to + tcp;
}

std::string capture_of(const std::vector<Packet>& packets, Net net = Net::ethernet) {
  std::string file =
      "\xD4\xC3\xB2\xA1" + little(2, 2) + little(4, 2) + little(0, 8) + little(65'535, 4) + little(1, 4);
  for (const Packet& packet : packets) {
    std::string frame(12, '\x02');
    if (net == Net::vlan) frame += std::string("\x81\x00\x00\x05", 4);
    frame += net == Net::ipv6 ? "\x86\xDD" : std::string("\x08\x00", 2);
    frame += ip_packet(packet, net);
    frame.resize(std::max<std::size_t>(frame.size(), 60));  // Ethernet's padding
    file += little(0, 8) + little(frame.size(), 4) + little(frame.size(), 4) + frame;
  }
  return file;
}

NetworkCapture read(const std::string& file) {
  auto out = read_network_capture(file, "test");
  EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().text());
  return out.ok() ? std::move(out).value() : NetworkCapture{};
}

/// Everything that one stream gave, with "|" where something is missing.
std::string text_of(TcpStreamBytes& stream) {
  std::string out;
  for (const TcpStreamBytes::Run& run : stream.take())
    out += (run.after_gap ? "|" : "") + std::string(run.bytes.begin(), run.bytes.end());
  return out;
}

TEST(TcpStreamBytes, any_order_with_repetitions_gives_the_same_bytes) {
  auto random = test::seeded(31);
  for (int round = 0; round < 500; ++round) {
    ByteString sent(1 + random() % 400);
    for (auto& byte : sent) byte = test::random_byte(random);
    const std::uint32_t first = round % 2 == 0 ? random() : 0xFFFFFF80U + random() % 128;  // wraps
    struct Cut {
      std::size_t begin, size;
    };
    std::vector<Cut> cuts;
    for (std::size_t at = 0; at < sent.size();) {
      const std::size_t size = std::min<std::size_t>(1 + random() % 60, sent.size() - at);
      cuts.push_back({at, size});
      if (random() % 3 == 0) cuts.push_back({at - std::min<std::size_t>(at, random() % 20), size});
      at += size;
    }
    for (std::size_t i = cuts.size(); i > 1; --i) std::swap(cuts[i - 1], cuts[random() % i]);
    TcpStreamBytes stream;
    stream.on_start(first - 1);
    for (const Cut& cut : cuts)
      stream.on_segment(first + static_cast<std::uint32_t>(cut.begin),
                        Bytes(sent).subspan(cut.begin, cut.size));
    stream.finish();
    EXPECT_EQ(text_of(stream), std::string(sent.begin(), sent.end()));
    EXPECT_EQ(stream.gaps(), 0U);
    EXPECT_EQ(stream.bytes(), sent.size());
  }
}

TEST(TcpStreamBytes, what_was_not_captured_is_a_gap_of_known_length) {
  const ByteString text = test::bytes_of("abcdefghij");
  TcpStreamBytes stream;
  stream.on_segment(100, Bytes(text).first(3));
  stream.on_segment(106, Bytes(text).subspan(6));
  EXPECT_EQ(text_of(stream), "abc") << "the rest may still come";
  stream.on_acknowledged(110);
  EXPECT_EQ(text_of(stream), "|ghij");
  EXPECT_EQ(stream.lost(), 3U);
  stream.on_segment(103, Bytes(text).subspan(3, 3));
  EXPECT_EQ(text_of(stream), "") << "too late";
  stream.on_segment(112, Bytes(text).first(1));
  stream.finish();
  EXPECT_EQ(text_of(stream), "|a");
  EXPECT_EQ(stream.gaps(), 2U);
}

TEST(TcpStreamBytes, the_end_of_a_connection_is_no_gap_and_a_new_one_begins_behind_one) {
  const ByteString text = test::bytes_of("abc");
  TcpStreamBytes stream;
  stream.on_start(99);
  stream.on_segment(100, text);
  stream.on_acknowledged(104);  // data and the mark of the end
  EXPECT_EQ(stream.gaps(), 0U);
  stream.on_start(3'000'000'000U);
  stream.on_segment(3'000'000'001U, text);
  EXPECT_EQ(text_of(stream), "abc|abc");
  EXPECT_EQ(stream.lost(), 0U);
}

TEST(NetworkCapture, padding_tags_and_both_kinds_of_addresses_are_taken_off) {
  for (const Net net : {Net::ethernet, Net::vlan, Net::ipv6}) {
    NetworkCapture capture =
        read(capture_of({{.sequence = 1, .data = "ab"}, {.sequence = 3, .data = "c"}}, net));
    ASSERT_EQ(capture.streams.size(), 1U);
    EXPECT_EQ(text_of(capture.streams[0].stream), "abc");
    EXPECT_EQ(capture.streams[0].from_port, 2112U);
    EXPECT_TRUE(capture.streams[0].from.ends_with(":2112")) << capture.streams[0].from;
    EXPECT_EQ(capture.other_packets, 0U);
  }
}

TEST(NetworkCapture, directions_and_connections_are_kept_apart) {
  NetworkCapture capture =
      read(capture_of({{.sequence = 1, .data = "ab"},
                       {.from_port = 40'000, .to_port = 2112, .sequence = 7, .data = "X", .host = 9},
                       {.to_port = 40'001, .sequence = 9, .data = "cd"},
                       {.sequence = 3, .data = "ef"}}));
  ASSERT_EQ(capture.streams.size(), 3U);
  EXPECT_EQ(text_of(capture.streams[0].stream), "abef");
  EXPECT_EQ(text_of(capture.streams[1].stream), "X");
  EXPECT_EQ(text_of(capture.streams[2].stream), "cd");
}

TEST(NetworkCapture, no_cut_or_changed_file_is_read_past_its_end) {
  const std::string whole = capture_of({{.sequence = 1, .data = "ab"}, {.sequence = 3, .data = "cd"}});
  for (std::size_t length = 0; length < whole.size(); ++length)
    (void)read_network_capture(whole.substr(0, length), "test");
  auto random = test::seeded(32);
  for (int i = 0; i < 3000; ++i) {
    std::string changed = whole;
    changed[24 + random() % (changed.size() - 24)] = static_cast<char>(random() & 0xFF);
    (void)read_network_capture(changed, "test");
  }
}

/// A text telegram of a SICK.
std::string telegram(const std::string& text) { return "\x02" + text + "\x03"; }

TEST(DecodeCapture, telegrams_are_read_across_segments_and_what_is_missing_is_told) {
  const std::string one = telegram("sRA DeviceIdent 4 LMS1 1 A"), two = telegram("sRA SCdevicestate 1");
  const std::string all = one + two + one;
  const auto part = [&](std::size_t begin, std::size_t size, std::size_t sequence) {
    return Packet{.sequence = static_cast<std::uint32_t>(sequence), .data = all.substr(begin, size)};
  };
  // The second half comes first, the first half twice.
  const std::size_t half = one.size() / 2;
  auto lines = lines_of(decode("sick",
                               capture_of({part(0, 1, 1), part(half, all.size() - half, 1 + half),
                                           part(1, half - 1, 2), part(1, half - 1, 2)}),
                               "", "test"));
  const auto count = [&](const std::string& name) {
    return std::count_if(lines.begin(), lines.end(),
                         [&](const auto& l) { return l.value("name", "") == name; });
  };
  EXPECT_EQ(count("cola_telegram"), 3);
  EXPECT_EQ(lines.back()["bytes_in"], all.size());
  EXPECT_EQ(lines.back()["rejected"]["capture_gaps"], 0);
  EXPECT_EQ(lines[0]["name"], "tcp_stream");
  EXPECT_EQ(lines[0]["from"], "192.168.0.1:2112");
  EXPECT_EQ(lines[0]["repeated_bytes"], half - 1);
  // The middle one is missing.
  lines = lines_of(decode("sick",
                          capture_of({part(0, one.size(), 1), part(one.size() + two.size(), one.size(),
                                                                   1 + one.size() + two.size())}),
                          "", "test"));
  EXPECT_EQ(count("cola_telegram"), 2);
  EXPECT_EQ(lines.back()["rejected"]["capture_gaps"], 1);
  EXPECT_EQ(lines[0]["lost_bytes"], two.size());
}

TEST(DecodeCapture, what_does_not_come_over_tcp_is_refused_by_name) {
  const std::string file = capture_of({{.sequence = 1, .data = "ab"}});
  for (const std::string driver : {"ld06", "xv11", "canopen:zlac8015d", "vesc", "arcos"}) {
    const auto text = decode(driver, file, "drivers/base/profiles", "f.pcap");
    ASSERT_FALSE(text.ok()) << driver;
    EXPECT_NE(text.error().text().find("network capture"), std::string::npos);
  }
  const auto two =
      decode("sick", capture_of({{.sequence = 1, .data = "ab"}, {.sequence = 1, .data = "ab", .host = 2}}),
             "", "f.pcap");
  ASSERT_FALSE(two.ok());
  EXPECT_NE(two.error().text().find("192.168.0.2:2112"), std::string::npos);
  EXPECT_FALSE(decode("sick", capture_of({}), "", "f.pcap").ok());
  std::string bluetooth = file;
  bluetooth[20] = '\xC9';
  EXPECT_EQ(decode("sick", bluetooth, "", "f.pcap").error().code, ErrorCode::format);
}

TEST(DecodeCapture, a_file_that_was_cut_off_is_read_to_its_end_and_that_is_said) {
  const std::string one = telegram("sRA SCdevicestate 1");
  const std::string file = capture_of({{.sequence = 1, .data = one}, {.sequence = 1 + 21, .data = one}});
  const auto lines = lines_of(decode("sick", file.substr(0, file.size() - 5), "", "f.pcap"));
  EXPECT_EQ(lines.back()["rejected"]["capture_cut_off"], 1);
  EXPECT_EQ(lines.back()["good"], one.size());
}

}  // namespace
}  // namespace odomcalib::drivers::network_capture_test
