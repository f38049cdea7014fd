#include "drivers/decode/network_capture.hpp"

#include <arpa/inet.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>

namespace odomcalib::drivers {
namespace {

constexpr unsigned kIpv4 = 0x0800, kIpv6 = 0x86DD, kVlan = 0x8100, kServiceVlan = 0x88A8;  // EtherTypes
constexpr std::uint8_t kTcp = 6;
constexpr std::uint8_t kSyn = 0x02, kAck = 0x10;  // flags

struct Segment {
  std::string from, to;
  unsigned from_port = 0;
  std::uint32_t sequence = 0, acknowledged = 0;
  std::uint8_t flags = 0;
  Bytes data;
};

unsigned big16(ByteReader& reader) { return static_cast<unsigned>(reader.big_endian(2)); }

std::string address_text(int family, Bytes address, unsigned port) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (inet_ntop(family, address.data(), text.data(), text.size()) == nullptr) return {};
  const std::string host = family == AF_INET6 ? "[" + std::string(text.data()) + "]" : text.data();
  return host + ":" + std::to_string(port);
}

/// Behind VLAN tags.
unsigned ether_type(ByteReader& reader) {
  unsigned type = big16(reader);
  while (reader.ok() && (type == kVlan || type == kServiceVlan)) {
    reader.take(2);
    type = big16(reader);
  }
  return type;
}

/// Link types that carry IP, as libpcap numbers them.
bool carries_ip(int link) {
  constexpr std::array kLinks = {DLT_EN10MB, DLT_RAW,       DLT_IPV4,      DLT_IPV6,
                                 DLT_NULL,   DLT_LINUX_SLL, DLT_LINUX_SLL2};
  return std::find(kLinks.begin(), kLinks.end(), link) != kLinks.end();
}

/// Takes the link's header off. False when no IP packet follows.
bool skip_link(int link, ByteReader& reader) {
  if (link == DLT_EN10MB) {
    reader.take(12);
    const unsigned type = ether_type(reader);
    return type == kIpv4 || type == kIpv6;
  }
  if (link == DLT_LINUX_SLL) {
    reader.take(14);
    const unsigned type = ether_type(reader);
    return type == kIpv4 || type == kIpv6;
  }
  if (link == DLT_LINUX_SLL2) {
    const unsigned type = big16(reader);
    reader.take(18);
    return type == kIpv4 || type == kIpv6;
  }
  if (link == DLT_NULL) reader.take(4);  // an address family, which the IP version says again
  return true;
}

/// The segment in an IP packet; nullopt when it is none, or a fragment of one.
std::optional<Segment> read_segment(Bytes packet) {
  if (packet.empty()) return std::nullopt;
  const bool v6 = packet[0] >> 4U == 6;
  if (!v6 && packet[0] >> 4U != 4) return std::nullopt;
  ByteReader ip(packet);
  const std::size_t head = v6 ? 40 : 4 * (packet[0] & 15U);
  ip.take(v6 ? 4 : 2);
  const std::size_t stated = big16(ip);
  // 0 where the network card cuts the segments: then what was captured is the packet.
  const std::size_t length = stated == 0 ? packet.size() : stated + (v6 ? head : 0);
  if (!v6) ip.take(2);
  const unsigned fragment = v6 ? 0 : big16(ip) & 0x3FFFU;
  if (!v6) ip.take(1);
  const std::uint8_t protocol = ip.u8();
  ip.take(v6 ? 1 : 2);
  const std::size_t size = v6 ? 16 : 4;
  const Bytes from = ip.take(size), to = ip.take(size);
  if (!ip.ok() || head < 20 || fragment != 0 || protocol != kTcp) return std::nullopt;
  // Short Ethernet frames are padded; a packet that was cut off by the capture is shorter than it says.
  packet = packet.first(std::min(length, packet.size()));
  if (packet.size() < head) return std::nullopt;
  ByteReader tcp(packet.subspan(head));
  Segment out;
  out.from_port = big16(tcp);
  const unsigned to_port = big16(tcp);
  out.sequence = static_cast<std::uint32_t>(tcp.big_endian(4));
  out.acknowledged = static_cast<std::uint32_t>(tcp.big_endian(4));
  const std::size_t data_at = std::size_t{4} * (tcp.u8() >> 4U);
  out.flags = tcp.u8();
  if (!tcp.ok() || data_at < 20 || packet.size() < head + data_at) return std::nullopt;
  out.from = address_text(v6 ? AF_INET6 : AF_INET, from, out.from_port);
  out.to = address_text(v6 ? AF_INET6 : AF_INET, to, to_port);
  out.data = packet.subspan(head + data_at);
  return out;
}

class Streams {
 public:
  void on_segment(const Segment& segment) {
    TcpStreamBytes& own = of(segment.from, segment.to, segment.from_port);
    const bool begins = (segment.flags & kSyn) != 0;
    if (begins) own.on_start(segment.sequence);
    if (!begins) own.on_segment(segment.sequence, segment.data);
    if ((segment.flags & kAck) == 0) return;
    if (CapturedStream* other = find(segment.to, segment.from))
      other->stream.on_acknowledged(segment.acknowledged);
  }

  /// Those with data.
  std::vector<CapturedStream> finish() {
    for (CapturedStream& one : streams_) one.stream.finish();
    std::erase_if(streams_, [](const CapturedStream& one) { return one.stream.bytes() == 0; });
    return std::move(streams_);
  }

 private:
  CapturedStream* find(const std::string& from, const std::string& to) {
    const auto found = std::find_if(streams_.begin(), streams_.end(), [&](const CapturedStream& one) {
      return one.from == from && one.to == to;
    });
    return found == streams_.end() ? nullptr : &*found;
  }
  TcpStreamBytes& of(const std::string& from, const std::string& to, unsigned from_port) {
    if (CapturedStream* known = find(from, to)) return known->stream;
    streams_.push_back({from, to, from_port, {}});
    return streams_.back().stream;
  }

  std::vector<CapturedStream> streams_;
};

struct CloseCapture {
  void operator()(pcap_t* capture) const { pcap_close(capture); }
};
using OpenCapture = std::unique_ptr<pcap_t, CloseCapture>;

Error unreadable(const std::string& why, const std::string& where) {
  return {ErrorCode::format, "libpcap cannot read the network capture: " + why, where,
          "record with `tcpdump -i eth0 -s 0 -w FILE host ADDRESS`"};
}

Result<OpenCapture> open_capture(std::string_view file, const std::string& where) {
  // Opened for reading: nothing is written through this pointer.
  std::FILE* stream = fmemopen(const_cast<char*>(file.data()), file.size(), "rb");
  if (stream == nullptr) return unreadable("no memory", where);
  std::array<char, PCAP_ERRBUF_SIZE> why{};
  OpenCapture capture(pcap_fopen_offline(stream, why.data()));
  if (capture) return capture;
  std::fclose(stream);
  return unreadable(why.data(), where);
}

}  // namespace

bool is_network_capture(std::string_view file) {
  using namespace std::string_view_literals;
  constexpr std::array kMagics = {"\xA1\xB2\xC3\xD4"sv, "\xD4\xC3\xB2\xA1"sv, "\xA1\xB2\x3C\x4D"sv,
                                  "\x4D\x3C\xB2\xA1"sv, "\x0A\x0D\x0D\x0A"sv};
  return std::any_of(kMagics.begin(), kMagics.end(),
                     [&](std::string_view magic) { return file.starts_with(magic); });
}

Result<NetworkCapture> read_network_capture(std::string_view file, const std::string& where) {
  auto opened = open_capture(file, where);
  if (!opened) return opened.error();
  pcap_t* const capture = opened.value().get();
  const int link = pcap_datalink(capture);
  if (!carries_ip(link)) {
    const char* const name = pcap_datalink_val_to_description_or_dlt(link);
    return Error{ErrorCode::format, std::string("the network capture is of a link without IP: ") + name,
                 where, "capture at the network interface that the lidar is connected to"};
  }
  NetworkCapture out;
  Streams streams;
  pcap_pkthdr* header = nullptr;
  const std::uint8_t* data = nullptr;
  int state = 1;
  while ((state = pcap_next_ex(capture, &header, &data)) == 1) {
    ++out.packets;
    const Bytes packet(data, header->caplen);
    ByteReader reader(packet);
    const bool is_ip = skip_link(link, reader) && reader.ok();
    const auto segment = is_ip ? read_segment(packet.subspan(packet.size() - reader.left())) : std::nullopt;
    if (segment)
      streams.on_segment(*segment);
    else
      ++out.other_packets;
  }
  if (state == PCAP_ERROR) out.cut_off = pcap_geterr(capture);
  out.streams = streams.finish();
  return out;
}

}  // namespace odomcalib::drivers
