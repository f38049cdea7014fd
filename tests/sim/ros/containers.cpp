#include "tests/sim/ros/containers.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace odomcalib::sim {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Little-endian, as all three formats are.
template <typename Number>
std::string raw(Number value) {
  std::string out;
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    out += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
  return out;
}

std::string sized(const std::string& bytes) { return raw(static_cast<std::uint32_t>(bytes.size())) + bytes; }

// ---- bag 2.0

std::string field(const std::string& name, const std::string& value) { return sized(name + "=" + value); }

std::string record(const std::string& header, const std::string& data) { return sized(header) + sized(data); }

std::string bag_time(std::int64_t ns) {
  return raw(static_cast<std::uint32_t>(ns / kSecond_ns)) + raw(static_cast<std::uint32_t>(ns % kSecond_ns));
}

std::string op(char code) { return field("op", std::string(1, code)); }

std::string bag_header(std::uint64_t index, std::size_t connections, std::size_t chunks) {
  constexpr std::size_t kSize = 4096;
  const std::string header = field("index_pos", raw(index)) +
                             field("conn_count", raw(static_cast<std::uint32_t>(connections))) +
                             field("chunk_count", raw(static_cast<std::uint32_t>(chunks))) + op(3);
  return record(header, std::string(kSize - 8 - header.size(), ' '));
}

std::string connection(const RosLog& log, std::size_t topic) {
  const RosTopic& about = log.topics[topic];
  return record(op(7) + field("conn", raw(static_cast<std::uint32_t>(topic))) + field("topic", about.name),
                field("topic", about.name) + field("type", about.type) + field("md5sum", md5_of(about.type)) +
                    field("message_definition", definition_of(about.type, Wire::ros1)));
}

struct BagChunk {
  std::string bytes;
  std::map<std::size_t, std::string> index;         // by topic: time and place
  std::map<std::size_t, std::uint32_t> counts;      // by topic
  std::int64_t begin = INT64_MAX, end = INT64_MIN;  // ns

  void add(const RosMessage& message) {
    index[message.topic] += bag_time(message.received_ns) + raw(static_cast<std::uint32_t>(bytes.size()));
    ++counts[message.topic];
    bytes += record(op(2) + field("conn", raw(static_cast<std::uint32_t>(message.topic))) +
                        field("time", bag_time(message.received_ns)),
                    message.bytes);
    begin = std::min(begin, message.received_ns);
    end = std::max(end, message.received_ns);
  }
};

class BagWriter {
 public:
  BagWriter(const RosLog& log, const BagOptions& options) : log_(log), options_(options) {}

  std::string write() {
    std::vector<bool> described(log_.topics.size());
    BagChunk chunk;
    for (const RosMessage& message : log_.messages) {
      if (!described[message.topic]) chunk.bytes += connection(log_, message.topic);
      described[message.topic] = true;
      chunk.add(message);
      if (chunk.bytes.size() >= options_.chunk_bytes) finish(chunk);
    }
    if (!chunk.counts.empty()) finish(chunk);
    if (!options_.closed) return std::string(kMagic) + bag_header(0, 0, 0) + body_;
    std::string tail;
    for (std::size_t i = 0; i < log_.topics.size(); ++i) tail += connection(log_, i);
    return std::string(kMagic) + bag_header(place(), log_.topics.size(), chunks_) + body_ + tail + infos_;
  }

 private:
  [[nodiscard]] std::uint64_t place() const { return kMagic.size() + 4096 + body_.size(); }

  void finish(BagChunk& chunk) {
    static const std::map<RosPacking, std::string> kNames{
        {RosPacking::none, "none"}, {RosPacking::bz2, "bz2"}, {RosPacking::lz4, "lz4"}};
    std::string counts;
    for (const auto& [topic, count] : chunk.counts)
      counts += raw(static_cast<std::uint32_t>(topic)) + raw(count);
    infos_ += record(op(6) + field("ver", raw(std::uint32_t{1})) + field("chunk_pos", raw(place())) +
                         field("start_time", bag_time(chunk.begin)) + field("end_time", bag_time(chunk.end)) +
                         field("count", raw(static_cast<std::uint32_t>(chunk.counts.size()))),
                     counts);
    body_ += record(op(5) + field("compression", kNames.at(options_.packing)) +
                        field("size", raw(static_cast<std::uint32_t>(chunk.bytes.size()))),
                    packed(options_.packing, chunk.bytes));
    for (const auto& [topic, index] : chunk.index)
      body_ += record(op(4) + field("ver", raw(std::uint32_t{1})) +
                          field("conn", raw(static_cast<std::uint32_t>(topic))) +
                          field("count", raw(chunk.counts.at(topic))),
                      index);
    ++chunks_;
    chunk = {};
  }

  static constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
  const RosLog& log_;
  const BagOptions& options_;
  std::string body_, infos_;
  std::size_t chunks_ = 0;
};

// ---- MCAP

constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);

std::string mcap_record(char code, const std::string& content) {
  return std::string(1, code) + raw(static_cast<std::uint64_t>(content.size())) + content;
}

std::string mcap_channel(const RosLog& log, std::size_t topic) {
  const RosTopic& about = log.topics[topic];
  const bool ros1 = log.wire == Wire::ros1;
  const auto id = static_cast<std::uint16_t>(topic + 1);
  const std::string channel = sized(about.name) + sized(ros1 ? "ros1" : "cdr") + sized("");
  if (about.type.empty()) return mcap_record(4, raw(id) + raw(std::uint16_t{0}) + channel);  // no schema
  return mcap_record(3, raw(id) + sized(ros1 ? about.type : ros2_type(about.type)) +
                            sized(ros1 ? "ros1msg" : "ros2msg") +
                            sized(definition_of(about.type, log.wire))) +
         mcap_record(4, raw(id) + raw(id) + channel);
}

std::string mcap_message(const RosMessage& message, std::uint32_t sequence) {
  const auto time = static_cast<std::uint64_t>(message.received_ns);
  return mcap_record(5, raw(static_cast<std::uint16_t>(message.topic + 1)) + raw(sequence) + raw(time) +
                            raw(time) + message.bytes);
}

std::string mcap_chunk(const std::string& records, RosPacking packing, std::int64_t begin, std::int64_t end) {
  const std::string name = packing == RosPacking::lz4 ? "lz4" : packing == RosPacking::zstd ? "zstd" : "";
  const std::string bytes = packed(packing, records);
  const auto crc =
      static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()));
  return mcap_record(6, raw(begin) + raw(end) + raw(static_cast<std::uint64_t>(records.size())) + raw(crc) +
                            sized(name) + raw(static_cast<std::uint64_t>(bytes.size())) + bytes);
}

// ---- sqlite

struct CloseSqlite {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

class Sqlite {
 public:
  explicit Sqlite(const std::filesystem::path& path) {
    sqlite3* opened = nullptr;
    const int code = sqlite3_open(path.c_str(), &opened);
    database_.reset(opened);
    check(code == SQLITE_OK);
  }
  void run(const std::string& sql) {
    check(sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  }
  void insert(const std::string& sql, std::int64_t first, std::int64_t second, const std::string& blob) {
    sqlite3_stmt* prepared = nullptr;
    check(sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &prepared, nullptr) == SQLITE_OK);
    const std::unique_ptr<sqlite3_stmt, CloseSqlite> statement(prepared);
    sqlite3_bind_int64(prepared, 1, first);
    sqlite3_bind_int64(prepared, 2, second);
    sqlite3_bind_blob(prepared, 3, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
    check(sqlite3_step(prepared) == SQLITE_DONE);
  }

 private:
  void check(bool good) const {
    if (!good) throw std::runtime_error(sqlite3_errmsg(database_.get()));
  }
  std::unique_ptr<sqlite3, CloseSqlite> database_;
};

}  // namespace

std::string packed(RosPacking packing, const std::string& bytes) {
  std::string out;
  if (packing == RosPacking::none) return bytes;
  if (packing == RosPacking::bz2) {
    auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);
    out.resize(size);
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(bytes.data()),  // NOLINT
                             static_cast<unsigned>(bytes.size()), 9, 0, 0);
    out.resize(size);
  } else if (packing == RosPacking::lz4) {
    // As ROS 1 writes its frames, and reads no others: blocks that stand alone, a checksum at the end.
    LZ4F_preferences_t form{};
    form.frameInfo.blockMode = LZ4F_blockIndependent;
    form.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
    out.resize(LZ4F_compressFrameBound(bytes.size(), &form));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &form));
  } else {
    out.resize(ZSTD_compressBound(bytes.size()));
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3));
  }
  return out;
}

std::string write_bag(const RosLog& log, const BagOptions& options) {
  return BagWriter(log, options).write();
}

std::string write_mcap(const RosLog& log, const McapOptions& options) {
  std::string out = std::string(kMcapMagic) +
                    mcap_record(1, sized(log.wire == Wire::ros1 ? "ros1" : "ros2") + sized("simulated"));
  std::vector<bool> described(log.topics.size());
  std::string records;
  std::int64_t begin = 0;
  const auto finish = [&](std::int64_t end) {
    if (!records.empty())
      out += options.chunk_bytes == 0 ? records : mcap_chunk(records, options.packing, begin, end);
    records.clear();
  };
  std::uint32_t sequence = 0;
  for (const RosMessage& message : log.messages) {
    if (records.empty()) begin = message.received_ns;
    if (!described[message.topic]) records += mcap_channel(log, message.topic);
    described[message.topic] = true;
    records += mcap_message(message, sequence++);
    if (records.size() >= options.chunk_bytes) finish(message.received_ns);
  }
  finish(log.messages.empty() ? 0 : log.messages.back().received_ns);
  if (!options.closed) return out;
  return out + mcap_record(15, raw(std::uint32_t{0})) +
         mcap_record(2, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) + raw(std::uint32_t{0})) +
         std::string(kMcapMagic);
}

void write_rosbag2(const RosLog& log, const std::filesystem::path& path, const Rosbag2Options& options) {
  std::filesystem::remove(path);
  Sqlite database(path);
  database.run(options.write_ahead_log ? "PRAGMA journal_mode=WAL" : "PRAGMA journal_mode=MEMORY");
  database.run(
      "PRAGMA synchronous=OFF; BEGIN;"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      "  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      "  timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  for (std::size_t i = 0; i < log.topics.size(); ++i)
    database.run("INSERT INTO topics VALUES(" + std::to_string(i + 1) + ", '" + log.topics[i].name + "', '" +
                 ros2_type(log.topics[i].type) + "', 'cdr', '')");
  for (const RosMessage& message : log.messages)
    database.insert("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                    static_cast<std::int64_t>(message.topic + 1), message.received_ns,
                    options.packed_messages ? packed(RosPacking::zstd, message.bytes) : message.bytes);
  database.run("COMMIT");
}

}  // namespace odomcalib::sim
