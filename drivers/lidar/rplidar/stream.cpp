#include "drivers/lidar/rplidar/stream.hpp"

#include "drivers/lidar/rplidar/guess.hpp"
#include "drivers/lidar/rplidar/settings.hpp"

namespace odomcalib::drivers::rplidar {
namespace {

constexpr std::size_t kDescriptorBytes = 7;
constexpr std::uint8_t kSync1 = 0xA5, kSync2 = 0x5A;

struct Descriptor {
  std::uint32_t length = 0;
  bool multiple = false;
  std::uint8_t type = 0;
};

Descriptor read_descriptor(Bytes bytes) {
  ByteReader reader(bytes);
  reader.take(2);
  const std::uint32_t word = reader.u32();
  return {word & 0x3FFFFFFFU, word >> 30U != 0, reader.u8()};
}

bool sync_fits(Bytes rest) { return rest[0] == kSync1 && (rest.size() < 2 || rest[1] == kSync2); }

/// Measurement data contain the two sync bytes now and then; length, mode and type of a measurement as well
/// never in practice.
bool is_measurement(const Descriptor& descriptor) {
  const PacketFormat* format = find_format(descriptor.type);
  return format != nullptr && descriptor.multiple && descriptor.length == format->bytes;
}

bool run_fits(Bytes rest) {
  for (std::size_t i = 0; i < kStandardRun; ++i)
    if (!is_intact(PacketType::standard, rest.subspan(5 * i, 5))) return false;
  return true;
}

}  // namespace

void Stream::expect_descriptor() {
  format_ = nullptr;
  answer_bytes_.reset();
  frames_.reset();
}

void Stream::reset() { expect_descriptor(); }

void Stream::finish() {
  if (layout_open_) frames_.reject("ambiguous_capsule");
  layout_open_ = false;
}

Verdict Stream::take_descriptor(Bytes rest, std::vector<Item>& out) {
  if (rest.size() < kDescriptorBytes) return Verdict::wait();
  const Descriptor descriptor = read_descriptor(rest);
  if (is_measurement(descriptor)) {
    format_ = find_format(descriptor.type);
    in_step_ = true;
  } else if (descriptor.multiple) {
    guess_ = false;
    return Verdict::reject("unknown_packet_type", kDescriptorBytes);
  } else if (descriptor.length == 0 || descriptor.length > kMostAnswerBytes) {
    return Verdict::reject("bad_descriptor");
  } else {
    answer_bytes_ = descriptor.length;
    answer_type_ = descriptor.type;
  }
  out.push_back({Item::Kind::descriptor, descriptor.type, {}, rest.size() - kDescriptorBytes});
  return Verdict::good(kDescriptorBytes);
}

Verdict Stream::take_answer(Bytes rest, std::vector<Item>& out) {
  const std::size_t size = *answer_bytes_;
  if (rest.size() < size) return Verdict::wait();
  const Bytes bytes = rest.first(size);
  out.push_back({Item::Kind::answer, answer_type_, {bytes.begin(), bytes.end()}, rest.size() - size});
  answer_bytes_.reset();
  return Verdict::good(size);
}

Verdict Stream::lost_packet(Bytes rest) {
  in_step_ = false;
  const bool standard = format_->type == PacketType::standard;
  if (!may_begin(format_->type, rest)) return Verdict::noise();
  return Verdict::reject(standard ? "bad_check_bits" : "bad_checksum");
}

Verdict Stream::take_packet(Bytes rest, std::vector<Item>& out) {
  if (!may_begin(format_->type, rest)) return lost_packet(rest);
  const bool unsure = format_->type == PacketType::standard && !in_step_;
  if (rest.size() < format_->bytes * (unsure ? kStandardRun : 1)) return Verdict::wait();
  const Bytes bytes = rest.first(format_->bytes);
  if (unsure ? !run_fits(rest) : !is_intact(format_->type, bytes)) return lost_packet(rest);
  in_step_ = true;
  out.push_back({Item::Kind::packet,
                 static_cast<std::uint8_t>(format_->type),
                 {bytes.begin(), bytes.end()},
                 rest.size() - format_->bytes});
  return Verdict::good(format_->bytes);
}

/// Finds the type of a stream that began before we listened; consumes nothing once it is found.
Verdict Stream::guess_format(Bytes rest) {
  const Guess guess = guess_type(rest, guessed_);
  layout_open_ = guess.kind == Guess::Kind::wait && guess.type == PacketType::express;
  switch (guess.kind) {
    case Guess::Kind::none:
      return Verdict::noise();
    case Guess::Kind::wait:
      return Verdict::wait();
    case Guess::Kind::ambiguous:
      return Verdict::reject("ambiguous_capsule",
                             find_format(static_cast<unsigned>(PacketType::express))->bytes);
    case Guess::Kind::found:
      break;
  }
  format_ = find_format(static_cast<unsigned>(guess.type));
  in_step_ = true;
  return Verdict::good(0);
}

Verdict Stream::look(Bytes rest, std::vector<Item>& out) {
  if (answer_bytes_) return take_answer(rest, out);
  if (sync_fits(rest) && rest.size() < kDescriptorBytes) return Verdict::wait();
  const bool descriptor = sync_fits(rest) && (format_ == nullptr || is_measurement(read_descriptor(rest)));
  if (descriptor) return take_descriptor(rest, out);
  if (format_ == nullptr && guess_) {
    const Verdict verdict = guess_format(rest);
    if (format_ == nullptr) return verdict;
  }
  return format_ != nullptr ? take_packet(rest, out) : Verdict::noise();
}

std::vector<Item> Stream::on_bytes(Bytes bytes) {
  std::vector<Item> out;
  frames_.feed(bytes, [&](Bytes rest) { return look(rest, out); });
  return out;
}

}  // namespace odomcalib::drivers::rplidar
