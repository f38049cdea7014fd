#include "proto/wire/event_log.hpp"

#include <algorithm>

#include "proto/wire/byte_reader.hpp"

namespace odomcalib {
namespace {

constexpr std::string_view kMagic("\xED\xA1\xDA\x01", 4);
constexpr std::size_t kHeader = 28;
constexpr std::uint32_t kLongestChannel = 63;
constexpr std::uint32_t kLargestData = std::uint32_t{64} << 20;
constexpr std::size_t kNearBegin = 4096;

struct Header {
  LogEvent event;
  std::uint32_t channel_length = 0;
  std::uint32_t data_length = 0;

  [[nodiscard]] bool plausible() const {
    return channel_length >= 1 && channel_length <= kLongestChannel && data_length <= kLargestData;
  }
  [[nodiscard]] std::size_t size() const { return kHeader + channel_length + data_length; }
};

Header read_header(std::string_view bytes) {
  ByteReader reader(bytes.substr(kMagic.size()));
  Header header;
  header.event.number = reader.big_endian<std::int64_t>();
  header.event.time_us = reader.big_endian<std::int64_t>();
  header.channel_length = reader.big_endian<std::uint32_t>();
  header.data_length = reader.big_endian<std::uint32_t>();
  return header;
}

bool is_channel(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c <= '~'; });
}

}  // namespace

std::optional<LogEvent> EventLogReader::event_at(std::size_t at, std::size_t& size) const {
  const auto rest = bytes_.substr(at);
  if (rest.size() < kHeader) return std::nullopt;
  auto header = read_header(rest);
  if (!header.plausible() || header.size() > rest.size()) return std::nullopt;
  header.event.channel = rest.substr(kHeader, header.channel_length);
  header.event.data = rest.substr(kHeader + header.channel_length, header.data_length);
  if (!is_channel(header.event.channel)) return std::nullopt;
  size = header.size();
  const auto behind = rest.substr(size);
  // A length that was damaged swallows the next events: nothing valid follows, but an event begins inside.
  const bool followed = behind.empty() || behind.starts_with(kMagic);
  if (!followed && header.event.data.find(kMagic) != std::string_view::npos) return std::nullopt;
  return header.event;
}

/// Too few bytes for its own lengths, and no other event behind: the end of a log that was being written.
bool EventLogReader::is_unfinished(std::size_t at) const {
  const auto rest = bytes_.substr(at);
  if (rest.find(kMagic, kMagic.size()) != std::string_view::npos) return false;
  if (rest.size() < kHeader) return true;
  const auto header = read_header(rest);
  return header.plausible() && header.size() > rest.size();
}

void EventLogReader::skip_to(std::size_t at) {
  if (at == at_) return;
  ++counters_.garbage;
  counters_.skipped += at - at_;
  at_ = at;
}

std::optional<LogEvent> EventLogReader::next() {
  std::size_t from = at_;
  for (;;) {
    const std::size_t found = bytes_.find(kMagic, from);
    if (found == std::string_view::npos) {
      skip_to(bytes_.size());
      return std::nullopt;
    }
    std::size_t size = 0;
    if (const auto event = event_at(found, size)) {
      skip_to(found);
      counters_.good += size;
      at_ += size;
      return event;
    }
    if (is_unfinished(found)) {
      skip_to(found);
      counters_.cut_off += bytes_.size() - found;
      at_ = bytes_.size();
      return std::nullopt;
    }
    ++counters_.damaged;
    from = found + 1;
  }
}

bool looks_like_event_log(std::string_view bytes) {
  return bytes.substr(0, kNearBegin).find(kMagic) != std::string_view::npos;
}

}  // namespace odomcalib
