// The journal of the write-back as a disk may hold it after a crash: any bytes. First byte: the state of the
// record that is appended; then the file. No fuzzer finds a checksum: a line that begins with eight
// underscores gets its own.
#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "daemon/writeback/journal.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using namespace odomcalib;
using fuzz::require;

constexpr std::string_view kWanted = "________";  // where a line's checksum belongs
constexpr int kStates = static_cast<int>(JournalState::needs_operator) + 1;

std::string checksum(std::string_view text) {
  std::string digits(kWanted.size(), '0');
  auto crc = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, crc >>= 4U)
    *digit = "0123456789abcdef"[crc & 0xFU];
  return digits;
}

std::string with_checksums(std::string text) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = std::string_view(text).substr(begin, end - begin);
    if (line.size() > kWanted.size() && line.starts_with(kWanted))
      text.replace(begin, kWanted.size(), checksum(line.substr(kWanted.size() + 1)));
    begin = end + 1;
  }
  return text;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whole lines alone: what is behind the last one is torn.
std::string whole_lines(const std::string& text) { return text.substr(0, text.rfind('\n') + 1); }

/// The newest line that reads, found from the end.
std::optional<JournalRecord> newest(std::string_view lines) {
  while (!lines.empty()) {
    lines.remove_suffix(1);
    const std::size_t begin = lines.rfind('\n') + 1;  // 0 when there is none
    if (auto record = from_line(std::string(lines.substr(begin)))) return record;
    lines = lines.substr(0, begin);
  }
  return std::nullopt;
}

std::string text_of(const std::optional<JournalRecord>& record) { return record ? to_line(*record) : ""; }

/// A record that was read says the same when it is written and read again.
void check_round_trip(const JournalRecord& record) {
  std::string line = to_line(record);
  require(line.find('\n') == line.size() - 1);
  line.pop_back();
  const auto again = from_line(line);
  require(again && to_line(*again) == line + "\n");
  require(again->seq == record.seq && again->monotonic == record.monotonic &&
          again->wall_us == record.wall_us && again->state == record.state && again->label == record.label &&
          again->before == record.before && again->after == record.after && again->device == record.device &&
          again->calibration == record.calibration && again->store_begun == record.store_begun &&
          again->origin == record.origin);
}

void check_unfinished(const Journal& journal) {
  const auto& last = journal.last();
  const bool ended = !last || last->state == JournalState::commit || last->state == JournalState::rolled_back;
  require(journal.unfinished().has_value() != ended);
}

/// Numbers and a name from the input: whatever a controller may hold, as long as it is a number.
JournalRecord record_from(std::uint8_t first, std::string_view bytes) {
  JournalRecord record;
  record.state = static_cast<JournalState>(first % kStates);
  record.label = "apply";
  record.device = bytes.substr(0, 16);
  double value = 0.0;
  if (bytes.size() >= sizeof(value)) std::memcpy(&value, bytes.data(), sizeof(value));
  if (value - value == 0.0) record.before = {{"track_width", value}};
  record.after = {{"track_width", 0.4}};
  record.store_begun = (first & 0x80U) != 0;
  record.origin.entry = bytes.substr(0, 4);
  record.origin.nominal = record.before;
  if ((first & 0x40U) != 0) record.origin.user = first;
  return record;
}

void check(const std::filesystem::path& path, const std::string& text, const JournalRecord& appended) {
  const std::string lines = whole_lines(text);
  const auto last = newest(lines);
  if (last) check_round_trip(*last);

  const auto looked = Journal::open_read_only(path);
  require(looked.ok() && text_of(looked.value().last()) == text_of(last));
  require(content(path) == text);

  auto journal = Journal::open(path);
  require(journal.ok() && text_of(journal.value().last()) == text_of(last));
  check_unfinished(journal.value());
  // Behind the lines of a write-back that has not ended is the space for what may follow.
  require(journal.value().unfinished() ? content(path) == text : content(path) == lines);

  require(journal.value().append(appended).ok());
  const std::string line = text_of(journal.value().last());
  require(content(path).starts_with(lines + line));
  require(journal.value().unfinished() || content(path) == lines + line);
  const auto again = Journal::open(path);
  require(again.ok() && text_of(again.value().last()) == line);
  require(again.value().last()->state == appended.state);
  check_unfinished(again.value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::ScratchFolder folder;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  const std::string text = with_checksums(std::string(bytes));
  const auto path = folder.path() / "journal";
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  check(path, text, record_from(data[0], bytes));
  return 0;
}
