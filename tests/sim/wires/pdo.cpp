#include "tests/sim/wires/pdo.hpp"

#include <algorithm>

namespace odomcalib::sim {

namespace {

constexpr std::uint8_t kCobId = 1, kType = 2, kInhibit = 3, kTimer = 5;
constexpr std::uint32_t kPdoInvalid = 0x80000000U;

struct MappedObject {
  ObjectKey key;
  unsigned bytes;
};

MappedObject unpack(std::uint32_t entry) {
  return {{static_cast<std::uint16_t>(entry >> 16U), static_cast<std::uint8_t>(entry >> 8U)},
          (entry & 0xFFU) / 8U};
}

/// CiA 301, restricted COB-IDs.
bool restricted(std::uint32_t id) {
  const auto within = [id](std::uint32_t low, std::uint32_t high) { return id >= low && id <= high; };
  return id == 0 || within(0x001, 0x07F) || within(0x101, 0x180) || within(0x581, 0x5FF) ||
         within(0x601, 0x67F) || within(0x6E0, 0x6FF) || within(0x701, 0x7FF);
}

}  // namespace

Pdo::Pdo(ObjectDictionary& dictionary, std::uint16_t communication, std::uint16_t mapping,
         const PdoDefaults& defaults, std::function<bool()> configurable)
    : dictionary_(dictionary),
      communication_(communication),
      mapping_(mapping),
      configurable_(std::move(configurable)) {
  add_communication(defaults);
  add_mapping(defaults);
}

void Pdo::add_communication(const PdoDefaults& defaults) {
  dictionary_.add_value({communication_, 0}, 1, 5);
  dictionary_.add_value({communication_, kCobId}, 4, defaults.cob_id, Access::read_write).before_write =
      [this](std::uint32_t value) { return check_cob_id(value); };
  dictionary_.add_value({communication_, kType}, 1, 255, Access::read_write).before_write =
      [this](std::uint32_t value) { return check_type(value); };
  dictionary_.add_value({communication_, kInhibit}, 2, 0, Access::read_write).before_write =
      [this](std::uint32_t) { return valid() ? abort_code::kState : abort_code::kNone; };
  dictionary_.add_value({communication_, kTimer}, 2, defaults.event_timer_ms, Access::read_write);
}

void Pdo::add_mapping(const PdoDefaults& defaults) {
  const auto count = static_cast<std::uint32_t>(defaults.mapping.size());
  dictionary_.add_value({mapping_, 0}, 1, count, Access::read_write).before_write =
      [this](std::uint32_t value) { return check_count(value); };
  for (unsigned i = 0; i < kEntries; ++i) {
    const std::uint32_t entry = i < defaults.mapping.size() ? defaults.mapping[i] : 0;
    dictionary_.add_value({mapping_, static_cast<std::uint8_t>(i + 1)}, 4, entry, Access::read_write)
        .before_write = [this](std::uint32_t value) { return check_entry(value); };
  }
}

AbortCode Pdo::check_cob_id(std::uint32_t value) const {
  if (!configurable_()) return abort_code::kState;
  const std::uint32_t wanted = value & 0x7FFU;
  if (valid() && (value & kPdoInvalid) == 0 && wanted != id()) return abort_code::kState;
  return (value & 0x3FFFF800U) != 0 || restricted(wanted) ? abort_code::kRange : abort_code::kNone;
}

AbortCode Pdo::check_type(std::uint32_t value) const {
  if (!configurable_() || valid()) return abort_code::kState;
  const bool known = (value >= 1 && value <= 240) || value == 254 || value == 255;
  return known ? abort_code::kNone : abort_code::kRange;
}

AbortCode Pdo::check_count(std::uint32_t count) const {
  if (!configurable_() || valid()) return abort_code::kState;
  if (count > kEntries) return abort_code::kRange;
  unsigned bytes = 0;
  for (unsigned i = 1; i <= count; ++i) {
    const auto mapped = unpack(dictionary_.value({mapping_, static_cast<std::uint8_t>(i)}));
    const Object* object = dictionary_.find(mapped.key);
    if (object == nullptr || !object->mappable) return abort_code::kNotMappable;
    bytes += mapped.bytes;
  }
  return bytes > 8 ? abort_code::kPdoTooLong : abort_code::kNone;
}

AbortCode Pdo::check_entry(std::uint32_t entry) const {
  if (!configurable_() || valid() || mapped_count() != 0) return abort_code::kState;
  const auto mapped = unpack(entry);
  const Object* object = dictionary_.find(mapped.key);
  if (object == nullptr) return abort_code::kNoObject;
  return object->mappable && object->bytes == mapped.bytes ? abort_code::kNone : abort_code::kNotMappable;
}

std::uint32_t Pdo::parameter(std::uint8_t sub) const { return dictionary_.value({communication_, sub}); }

std::uint32_t Pdo::mapped_count() const { return dictionary_.value({mapping_, 0}); }

bool Pdo::valid() const { return (parameter(kCobId) & kPdoInvalid) == 0; }

std::uint32_t Pdo::id() const { return parameter(kCobId) & 0x7FFU; }

std::vector<std::uint32_t> Pdo::mapping() const {
  std::vector<std::uint32_t> entries;
  for (std::uint32_t i = 1; i <= mapped_count(); ++i)
    entries.push_back(dictionary_.value({mapping_, static_cast<std::uint8_t>(i)}));
  return entries;
}

Frame TransmitPdo::compose() const {
  Frame frame;
  frame.id = id();
  for (const std::uint32_t entry : mapping()) {
    const auto mapped = unpack(entry);
    put_u32(&frame.data[frame.length], mapped.bytes, dictionary_.value(mapped.key));
    frame.length = static_cast<std::uint8_t>(frame.length + mapped.bytes);
  }
  return frame;
}

Frame TransmitPdo::send(double now, bool frozen) {
  last_sent_ = now;
  first_ = false;
  if (!frozen) last_ = compose();
  last_.id = id();
  return last_;
}

void TransmitPdo::start(double now) {
  first_ = true;
  last_sent_ = now;
  syncs_ = 0;
}

std::optional<Frame> TransmitPdo::poll(double now, bool frozen) {
  if (!valid() || parameter(kType) < 254) return std::nullopt;
  if (first_) return send(now, frozen);
  constexpr double kHalfStep = 0.0005;  // the clock that polls has steps of a millisecond
  const double waited = now - last_sent_ + kHalfStep;
  if (waited < 1e-4 * parameter(kInhibit)) return std::nullopt;
  const std::uint32_t timer = parameter(kTimer);
  const bool timer_due = timer != 0 && waited >= 1e-3 * timer;
  const bool changed = timer == 0 && !frozen && compose() != last_;
  if (!timer_due && !changed) return std::nullopt;
  return send(now, frozen);
}

std::optional<Frame> TransmitPdo::on_sync(bool frozen) {
  const std::uint32_t type = parameter(kType);
  if (!valid() || type > 240 || ++syncs_ < type) return std::nullopt;
  syncs_ = 0;
  return send(last_sent_, frozen);
}

void ReceivePdo::apply(const Frame& frame) {
  unsigned offset = 0;
  for (const std::uint32_t entry : mapping()) {
    const auto mapped = unpack(entry);
    dictionary_.write(mapped.key, std::span(frame.data).subspan(offset, mapped.bytes));
    offset += mapped.bytes;
  }
}

bool ReceivePdo::on_frame(const Frame& frame, double now) {
  unsigned needed = 0;
  for (const std::uint32_t entry : mapping()) needed += unpack(entry).bytes;
  if (frame.length < needed) return false;
  last_received_ = now;
  if (parameter(kType) <= 240)
    waiting_ = frame;
  else
    apply(frame);
  return true;
}

void ReceivePdo::on_sync() {
  if (waiting_) apply(*waiting_);
  waiting_.reset();
}

void ReceivePdo::start() {
  waiting_.reset();
  last_received_.reset();
}

bool ReceivePdo::timed_out(double now) const {
  const std::uint32_t timer = parameter(kTimer);
  return timer != 0 && last_received_ && now - *last_received_ > 1e-3 * timer;
}

}  // namespace odomcalib::sim
