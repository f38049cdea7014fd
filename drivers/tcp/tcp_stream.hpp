// A TCP client connection that never blocks. Device strings: "tcp:192.168.0.10:2112".
#pragma once

#include <memory>
#include <string>

#include "drivers/byte_stream.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

/// Begins to connect; ByteStream::connected() tells when it is done. How long to wait is the caller's
/// decision.
/// @param address numeric "192.168.0.10:2112" or "[fe80::1]:2112": looking a name up would block; see
/// host_lookup.hpp Errors: usage (address), device (no route).
Result<std::unique_ptr<ByteStream>> open_tcp(const std::string& address);

}  // namespace odomcalib::drivers
