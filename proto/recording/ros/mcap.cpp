#include <zlib.h>

#include <algorithm>
#include <map>

#include "proto/recording/ros/containers.hpp"
#include "proto/recording/ros/unpack.hpp"
#include "proto/wire/byte_reader.hpp"

namespace odomcalib::ros {
namespace {

constexpr std::size_t kMagicSize = 8;

enum McapOp : std::uint8_t { kSchema = 3, kChannel = 4, kMcapMessage = 5, kMcapChunk = 6, kDataEnd = 15 };

struct McapRecord {
  std::uint8_t op = 0;
  std::string_view content;
  bool whole = false;
};

/// The next record; of one that is cut off, what is there.
McapRecord next_mcap_record(ByteReader& reader) {
  McapRecord record;
  record.op = reader.little_endian<std::uint8_t>();
  const auto size = reader.little_endian<std::uint64_t>();
  if (!reader.ok()) return record;
  record.whole = size <= reader.left();
  record.content = reader.take(static_cast<std::size_t>(std::min<std::uint64_t>(size, reader.left())));
  return record;
}

std::string text(ByteReader& reader) {
  return std::string(reader.take(reader.little_endian<std::uint32_t>()));
}

std::optional<Packing> mcap_packing(const std::string& name) {
  if (name.empty()) return Packing::none;
  if (name == "lz4") return Packing::lz4;
  if (name == "zstd") return Packing::zstd;
  return std::nullopt;
}

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

class McapReader {
 public:
  explicit McapReader(Collector& collector) : collector_(collector) {}

  void read(std::string_view bytes) {
    ByteReader reader(bytes.substr(kMagicSize));
    while (!reader.at_end()) {
      const McapRecord record = next_mcap_record(reader);
      if (record.op == kMcapChunk)
        read_chunk(record);
      else if (record.whole)
        read_record(record);
      if (record.whole && record.op == kDataEnd) return;  // behind it, all that is said has been said before
      if (!record.whole) return collector_.discard("file", "cut off");
    }
    collector_.discard("file", "without its end: the recorder did not close it");
  }

 private:
  void read_chunk(const McapRecord& record) {
    ByteReader chunk(record.content);
    chunk.take(16);  // times of the first and the last message
    const auto size = chunk.little_endian<std::uint64_t>();
    const auto crc = chunk.little_endian<std::uint32_t>();
    const std::string name = text(chunk);
    const auto packed_size = chunk.little_endian<std::uint64_t>();
    const auto packing = mcap_packing(name);
    if (!chunk.ok() || !packing) return collector_.discard("chunk", "packed in a way that is not known");
    const bool cut = packed_size > chunk.left();
    const auto packed =
        chunk.take(static_cast<std::size_t>(std::min<std::uint64_t>(packed_size, chunk.left())));
    if (*packing == Packing::none) return read_records(packed, cut ? 0 : crc);
    const Unpacked unpacked = collector_.unpacker()(*packing, packed, size);
    if (!unpacked.whole) collector_.discard("chunk", unpacked.problem);
    read_records(unpacked.bytes, unpacked.whole ? crc : 0);
  }

  /// Reads the content of a chunk: schemas, channels, messages.
  /// @param crc 0: not known
  void read_records(std::string_view bytes, std::uint32_t crc) {
    if (crc != 0 && crc != crc_of(bytes)) return collector_.discard("chunk", "wrong checksum");
    ByteReader reader(bytes);
    while (!reader.at_end()) {
      const McapRecord record = next_mcap_record(reader);
      if (!record.whole) return collector_.discard("chunk", "cut off or damaged");
      read_record(record);
    }
  }

  void read_record(const McapRecord& record) {
    ByteReader reader(record.content);
    if (record.op == kSchema) read_schema(reader);
    if (record.op == kChannel) read_channel(reader);
    if (record.op == kMcapMessage) read_message(reader);
  }

  void read_schema(ByteReader& reader) {
    const auto id = reader.little_endian<std::uint16_t>();
    std::string name = text(reader);
    if (reader.ok()) schemas_[id] = std::move(name);
  }

  void read_channel(ByteReader& reader) {
    const auto id = reader.little_endian<std::uint16_t>();
    const auto schema = schemas_.find(reader.little_endian<std::uint16_t>());
    std::string name = text(reader);
    std::string encoding = text(reader);
    if (!reader.ok()) return collector_.discard("channel", "damaged");
    const std::size_t topic = collector_.topic(
        {std::move(name), schema == schemas_.end() ? "" : schema->second, std::move(encoding), ""});
    if (topic == Collector::kTooMany) return collector_.discard("channel", "too many topics");
    topics_[id] = topic;
  }

  void read_message(ByteReader& reader) {
    const auto topic = topics_.find(reader.little_endian<std::uint16_t>());
    reader.take(4);  // sequence number
    const auto logged = reader.little_endian<std::uint64_t>();
    reader.take(8);  // publish time: in ROS the same, or that of the publisher's machine
    if (!reader.ok() || topic == topics_.end())
      return collector_.discard("message", "without a topic or a time");
    collector_.message(topic->second, static_cast<std::int64_t>(logged), reader.take(reader.left()));
  }

  Collector& collector_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> topics_;  // by the number of the channel
};

}  // namespace

void read_mcap(std::string_view bytes, Collector& collector) { McapReader(collector).read(bytes); }

}  // namespace odomcalib::ros
