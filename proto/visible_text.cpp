#include "proto/visible_text.hpp"

#include <algorithm>
#include <cstddef>

namespace odomcalib {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
}

/// Bytes of the character that the text begins with; 0: none, or one that steers a terminal. RFC 3629.
std::size_t shown_bytes(std::string_view text) {
  const unsigned first = byte_at(text, 0), second = byte_at(text, 1);
  if (first < 0x80) return (first >= 0x20 && first != 0x7F) || first == '\n' || first == '\t' ? 1 : 0;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte_at(text, k) & 0xC0U) != 0x80) return 0;
  const bool control = first == 0xC2 && second < 0xA0;
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return control || overlong || beyond ? 0 : length;
}

}  // namespace

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./:=@_";
  const auto is_plain = [&](char c) {
    return static_cast<unsigned char>(c) >= 0x80 || kPlain.find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string visible(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t shown = shown_bytes(text);
    if (shown > 0)
      out.append(text.substr(0, shown));
    else
      out += '?';
    const bool control = shown == 0 && byte_at(text, 0) == 0xC2 && (byte_at(text, 1) & 0xC0U) == 0x80;
    text.remove_prefix(control ? 2 : std::max<std::size_t>(shown, 1));
  }
  return out;
}

std::streamsize VisibleText::xsputn(const char* text, std::streamsize size) {
  const std::string shown = visible({text, static_cast<std::size_t>(size)});
  const auto length = static_cast<std::streamsize>(shown.size());
  return onto_.sputn(shown.data(), length) == length ? size : 0;
}

VisibleText::int_type VisibleText::overflow(int_type letter) {
  if (traits_type::eq_int_type(letter, traits_type::eof())) return traits_type::not_eof(letter);
  const char one = traits_type::to_char_type(letter);
  return xsputn(&one, 1) == 1 ? letter : traits_type::eof();
}

}  // namespace odomcalib
