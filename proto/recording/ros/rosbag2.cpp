#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <memory>

#include "proto/recording/ros/containers.hpp"
#include "proto/wire/byte_reader.hpp"

namespace odomcalib::ros {
namespace {

// Steps of SQLite's machine for each byte of the file. A row needs some fifteen and has twenty bytes at
// least, so a sound file needs less than one; a page that refers to itself would go on for ever.
constexpr std::int64_t kStepsPerByte = 8;
constexpr int kStepsAtATime = 1000;
constexpr std::int64_t kStepsAtLeast = 1'000'000;

// sqlite.org/fileformat.html, 1.3: places in the header of the first 100 bytes.
constexpr std::size_t kHeaderSize = 100, kPageSizeAt = 16, kWriteVersionAt = 18, kReadVersionAt = 19,
                      kChangeCounterAt = 24, kPageCountAt = 28, kValidForAt = 92;

struct Close {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Close>;
using Statement = std::unique_ptr<sqlite3_stmt, Close>;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  return ByteReader(bytes.substr(at)).big_endian<std::uint32_t>();
}

std::size_t page_size(std::string_view bytes) {
  const auto stated = ByteReader(bytes.substr(kPageSizeAt)).big_endian<std::uint16_t>();
  return stated == 1 ? 65'536 : stated;
}

/// Pages that are there. A header that states another number makes SQLite refuse the whole file.
std::size_t whole_pages(std::string_view bytes) {
  return page_size(bytes) == 0 ? 0 : bytes.size() / page_size(bytes);
}

void set_number(std::string& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24U - 8U * i));
}

/// A copy whose header describes what is there, for files that were cut off and for those that a writer with
/// a write-ahead log left (SQLite cannot open these in memory).
std::string mended(std::string_view bytes) {
  std::string out(bytes.substr(0, whole_pages(bytes) * page_size(bytes)));
  if (out.size() < kHeaderSize) return out;
  out[kWriteVersionAt] = out[kReadVersionAt] = 1;
  set_number(out, kPageCountAt, static_cast<std::uint32_t>(whole_pages(bytes)));
  set_number(out, kValidForAt, number_at(out, kChangeCounterAt));
  return out;
}

/// Stops a query that goes on beyond all measure.
struct Patience {
  std::int64_t rounds = 0;
  static int lose(void* self) { return --static_cast<Patience*>(self)->rounds < 0 ? 1 : 0; }
};

class Rosbag2Reader {
 public:
  Rosbag2Reader(std::string_view bytes, const std::string& where, Collector& collector)
      : bytes_(bytes), where_(where), collector_(collector) {}

  std::optional<Error> read() {
    if (bytes_.size() < kHeaderSize) return no_tables("is too short");
    const bool cut = number_at(bytes_, kPageCountAt) > whole_pages(bytes_);
    const bool logged = bytes_[kWriteVersionAt] == 2 || bytes_[kReadVersionAt] == 2;
    if (cut) collector_.discard("file", "cut off");
    if (cut || logged || bytes_.size() % std::max<std::size_t>(page_size(bytes_), 1) != 0) {
      mended_ = mended(bytes_);
      bytes_ = mended_;
    }
    if (!open()) return no_tables("cannot be opened: " + message());
    if (!is_table("topics") || !is_table("messages"))
      return no_tables("has no tables \"topics\" and \"messages\"");
    if (auto error = read_topics()) return error;
    read_messages();
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::string message() const { return sqlite3_errmsg(database_.get()); }
  [[nodiscard]] Error no_tables(const std::string& what) const {
    return {ErrorCode::format, "as a rosbag2 recording (SQLite) it " + what, where_,
            "check it with: sqlite3 FILE 'PRAGMA integrity_check'"};
  }

  bool open() {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(":memory:", &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(raw);
    if (code != SQLITE_OK) return false;
    // A file from anywhere: no functions or triggers of its schema, no rows larger than itself.
    sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min<std::size_t>(bytes_.size(), 1'000'000'000)));
    patience_.rounds =
        std::max(kStepsAtLeast, kStepsPerByte * static_cast<std::int64_t>(bytes_.size())) / kStepsAtATime;
    sqlite3_progress_handler(raw, kStepsAtATime, Patience::lose, &patience_);
    // SQLite does not write through the pointer: the database is read-only.
    auto* data = reinterpret_cast<unsigned char*>(const_cast<char*>(bytes_.data()));  // NOLINT
    const auto size = static_cast<sqlite3_int64>(bytes_.size());
    return sqlite3_deserialize(raw, "main", data, size, size, SQLITE_DESERIALIZE_READONLY) == SQLITE_OK;
  }

  Statement prepare(const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr);
    return Statement(statement);
  }

  /// A real table: no view, nothing virtual.
  bool is_table(const std::string& name) {
    const Statement query = prepare("SELECT type, rootpage FROM sqlite_schema WHERE name = '" + name + "'");
    if (query == nullptr || sqlite3_step(query.get()) != SQLITE_ROW) return false;
    return text(query, 0) == "table" && sqlite3_column_int64(query.get(), 1) > 0;
  }

  static std::string text(const Statement& row, int column) { return std::string(bytes(row, column)); }
  static std::string_view bytes(const Statement& row, int column) {
    const void* data = sqlite3_column_blob(row.get(), column);
    const int size = sqlite3_column_bytes(row.get(), column);
    return data == nullptr ? std::string_view{}
                           : std::string_view(static_cast<const char*>(data), static_cast<std::size_t>(size));
  }

  std::optional<Error> read_topics() {
    const Statement query = prepare("SELECT id, name, type, serialization_format FROM topics");
    if (query == nullptr) return no_tables("has other tables than are known: " + message());
    int code = sqlite3_step(query.get());
    for (; code == SQLITE_ROW; code = sqlite3_step(query.get())) {
      const std::size_t topic = collector_.topic({text(query, 1), text(query, 2), text(query, 3), ""});
      if (topic == Collector::kTooMany)
        collector_.discard("topic", "too many topics");
      else
        topics_[sqlite3_column_int64(query.get(), 0)] = topic;
    }
    if (code != SQLITE_DONE) collector_.discard("file", "list of topics damaged: " + message());
    return std::nullopt;
  }

  /// In the order of the rows, which is that of recording: an order by time would need an index to be whole.
  void read_messages() {
    const Statement query = prepare("SELECT topic_id, timestamp, data FROM messages");
    if (query == nullptr) return collector_.discard("file", "messages cannot be read: " + message());
    int code = sqlite3_step(query.get());
    for (; code == SQLITE_ROW; code = sqlite3_step(query.get())) {
      const auto topic = topics_.find(sqlite3_column_int64(query.get(), 0));
      if (topic == topics_.end())
        collector_.discard("message", "of a topic that the file does not describe");
      else
        collector_.message(topic->second, sqlite3_column_int64(query.get(), 1), bytes(query, 2));
    }
    if (code != SQLITE_DONE) collector_.discard("file", "damaged, what follows was not read: " + message());
  }

  std::string mended_;
  std::string_view bytes_;
  const std::string& where_;
  Collector& collector_;
  Patience patience_;
  Database database_;
  std::map<std::int64_t, std::size_t> topics_;  // by their id
};

}  // namespace

std::optional<Error> read_rosbag2(std::string_view bytes, const std::string& where, Collector& collector) {
  return Rosbag2Reader(bytes, where, collector).read();
}

}  // namespace odomcalib::ros
