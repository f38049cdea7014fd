#include "drivers/lidar/cola/arguments.hpp"

#include <bit>
#include <charconv>
#include <cmath>

namespace odomcalib::drivers::cola {

/// Up to the next blank, which is consumed.
std::string Arguments::word() {
  std::string out;
  while (reader_.left() > 0) {
    const char c = static_cast<char>(reader_.u8());
    if (c == ' ') break;
    out += c;
  }
  ok_ = ok_ && !out.empty();
  return out;
}

/// Hexadecimal, or decimal with an explicit sign. Negative numbers come as two's complement.
std::uint32_t Arguments::word_number(std::size_t bytes) {
  const std::string text = word();
  const bool decimal = text.starts_with('+') || text.starts_with('-');
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  std::int64_t value = 0;
  const auto parsed = std::from_chars(begin, end, value, decimal ? 10 : 16);
  const std::int64_t limit = std::int64_t{1} << (8 * bytes);
  ok_ = ok_ && parsed.ec == std::errc{} && parsed.ptr == end && value < limit && value >= -limit / 2;
  return ok_ ? static_cast<std::uint32_t>(value) : 0;
}

std::uint32_t Arguments::number(std::size_t bytes) {
  if (dialect_ == Dialect::ascii) return word_number(bytes);
  return static_cast<std::uint32_t>(reader_.big_endian(bytes));
}

std::int32_t Arguments::signed_number(std::size_t bytes) {
  return static_cast<std::int32_t>(sign_extend(number(bytes), static_cast<unsigned>(8 * bytes)));
}

float Arguments::real() {
  const float value = std::bit_cast<float>(number(4));
  ok_ = ok_ && std::isfinite(value);
  return value;
}

std::string Arguments::fixed_text(std::size_t length) {
  if (dialect_ == Dialect::ascii) return word();
  const Bytes bytes = reader_.take(length);
  return {bytes.begin(), bytes.end()};
}

std::string Arguments::counted_text() {
  const std::size_t length = number(2);
  const Bytes bytes = reader_.take(length);
  if (dialect_ == Dialect::ascii && reader_.left() > 0) reader_.take(1);  // the blank behind it
  return {bytes.begin(), bytes.end()};
}

}  // namespace odomcalib::drivers::cola
