// Network captures (pcap, pcapng; read by libpcap) as what devices sent over TCP.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/decode/tcp_stream_bytes.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

/// One direction of the TCP connections from one address and port to one other.
struct CapturedStream {
  std::string from, to;  ///< "192.168.0.1:2112", "[fe80::1]:2112"
  unsigned from_port = 0;
  TcpStreamBytes stream;
};

struct NetworkCapture {
  std::vector<CapturedStream> streams;  ///< with data, in the order of their first segment
  std::uint64_t packets = 0;
  std::uint64_t other_packets = 0;  ///< neither TCP over IPv4 nor over IPv6, fragments, damaged headers
  std::string cut_off;              ///< why the file ends before its end; empty: it does not
};

/// Told by how the file begins.
bool is_network_capture(std::string_view file);

/// Error format: libpcap cannot read it, or it was captured on a link that carries no IP.
Result<NetworkCapture> read_network_capture(std::string_view file, const std::string& where);

}  // namespace odomcalib::drivers
