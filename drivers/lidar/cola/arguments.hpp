// Arguments of a CoLa telegram, the same fields in both dialects: binary and big-endian, or words of text.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::cola {

enum class Dialect { ascii, binary };

/// A shortage or a word that is no number is remembered (ok() turns false) and yields zeros.
class Arguments {
 public:
  Arguments(Dialect dialect, Bytes bytes) : dialect_(dialect), reader_(bytes) {}

  /// @param bytes 1, 2 or 4
  std::uint32_t number(std::size_t bytes);
  std::int32_t signed_number(std::size_t bytes);
  float real();
  /// Text of known length, such as the name of a channel.
  std::string fixed_text(std::size_t length);
  /// Text preceded by its length; it may contain blanks.
  std::string counted_text();

  [[nodiscard]] bool ok() const { return ok_ && reader_.ok(); }

 private:
  std::uint32_t word_number(std::size_t bytes);
  std::string word();

  Dialect dialect_;
  ByteReader reader_;
  bool ok_ = true;
};

}  // namespace odomcalib::drivers::cola
