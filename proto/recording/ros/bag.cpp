#include <algorithm>
#include <map>

#include "proto/recording/ros/containers.hpp"
#include "proto/recording/ros/unpack.hpp"
#include "proto/wire/byte_reader.hpp"

namespace odomcalib::ros {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::int64_t kNanoseconds = 1'000'000'000;

enum BagOp : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// "name=value" fields, each behind its length.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] std::string_view text(std::string_view name) const {
    ByteReader reader(bytes_);
    while (!reader.at_end() && reader.ok()) {
      const auto field = reader.take(reader.little_endian<std::uint32_t>());
      if (field.size() > name.size() && field.starts_with(name) && field[name.size()] == '=')
        return field.substr(name.size() + 1);
    }
    return {};
  }
  /// A number that is not there in full is not there.
  template <typename Number>
  [[nodiscard]] std::optional<Number> number(std::string_view name) const {
    ByteReader reader(text(name));
    const auto value = reader.little_endian<Number>();
    return reader.at_end() ? std::optional(value) : std::nullopt;
  }

 private:
  std::string_view bytes_;
};

struct BagRecord {
  Fields header{{}};
  std::string_view data;
  std::optional<std::uint8_t> op;
  bool whole = false;
};

/// The next record; of one that is cut off in its data, what is there.
BagRecord next_bag_record(ByteReader& reader) {
  BagRecord record;
  record.header = Fields(reader.take(reader.little_endian<std::uint32_t>()));
  const std::size_t size = reader.little_endian<std::uint32_t>();
  if (!reader.ok()) return record;
  record.op = record.header.number<std::uint8_t>("op");
  record.whole = size <= reader.left();
  record.data = reader.take(std::min(size, reader.left()));
  return record;
}

std::optional<Packing> bag_packing(std::string_view name) {
  if (name == "none" || name.empty()) return Packing::none;
  if (name == "bz2") return Packing::bz2;
  if (name == "lz4") return Packing::lz4;
  return std::nullopt;
}

class BagReader {
 public:
  explicit BagReader(Collector& collector) : collector_(collector) {}

  std::optional<Error> read(std::string_view bytes, const std::string& where) {
    ByteReader reader(bytes.substr(kMagic.size()));
    bool closed = true;
    while (!reader.at_end()) {
      const BagRecord record = next_bag_record(reader);
      if (record.op == kBagHeader && !record.header.text("encryptor").empty())
        return Error{ErrorCode::format, "is an encrypted bag", where,
                     "decrypt it: rosbag decompress, on a machine that has the key"};
      // A recorder writes the place of the index when it closes the file.
      if (record.op == kBagHeader) closed = record.header.number<std::uint64_t>("index_pos") != 0;
      if (record.op == kChunk)
        read_chunk(record);
      else if (record.op && record.whole)
        read_record(record);
      if (!record.whole) {
        collector_.discard("file", "cut off");
        break;
      }
      if (!record.op) {
        collector_.discard("file", "damaged: what follows was not read");
        break;
      }
    }
    if (!closed) collector_.discard("file", "without its end: the recorder did not close it");
    return std::nullopt;
  }

 private:
  void read_chunk(const BagRecord& chunk) {
    const auto packing = bag_packing(chunk.header.text("compression"));
    const auto size = chunk.header.number<std::uint32_t>("size");
    if (!packing || !size) return collector_.discard("chunk", "packed in a way that is not known");
    if (*packing == Packing::none) return read_records(chunk.data);
    const Unpacked unpacked = collector_.unpacker()(*packing, chunk.data, *size);
    if (!unpacked.whole) collector_.discard("chunk", unpacked.problem);
    read_records(unpacked.bytes);
  }

  /// Reads the content of a chunk: connections and messages.
  void read_records(std::string_view bytes) {
    ByteReader reader(bytes);
    while (!reader.at_end()) {
      const BagRecord record = next_bag_record(reader);
      if (!record.whole || !record.op) return collector_.discard("chunk", "cut off or damaged");
      read_record(record);
    }
  }

  void read_record(const BagRecord& record) {
    if (record.op == kConnection) read_connection(record);
    if (record.op == kMessage) read_message(record);
  }

  void read_connection(const BagRecord& record) {
    const auto id = record.header.number<std::uint32_t>("conn");
    if (!id) return collector_.discard("connection", "without a number");
    const Fields about(record.data);
    const std::size_t topic =
        collector_.topic({std::string(record.header.text("topic")), std::string(about.text("type")), "ros1",
                          std::string(about.text("md5sum"))});
    if (topic == Collector::kTooMany) return collector_.discard("connection", "too many topics");
    topics_[*id] = topic;
  }

  void read_message(const BagRecord& record) {
    const auto id = record.header.number<std::uint32_t>("conn");
    const auto time = record.header.number<std::uint64_t>("time");  // seconds, then nanoseconds
    const auto topic = id ? topics_.find(*id) : topics_.end();
    if (topic == topics_.end() || !time) return collector_.discard("message", "without a topic or a time");
    const auto received = static_cast<std::int64_t>(*time & 0xFFFFFFFFU) * kNanoseconds +
                          static_cast<std::int64_t>(*time >> 32U);
    collector_.message(topic->second, received, record.data);
  }

  Collector& collector_;
  std::map<std::uint32_t, std::size_t> topics_;  // by the number of the connection
};

}  // namespace

std::optional<Error> read_bag(std::string_view bytes, const std::string& where, Collector& collector) {
  return BagReader(collector).read(bytes, where);
}

}  // namespace odomcalib::ros
