// Text of others on its way to a terminal: what a file or a device says must not steer it.
#pragma once

#include <streambuf>
#include <string>
#include <string_view>

namespace odomcalib {

/// Line ends and tabs stay; every other control character (of ASCII and, in UTF-8, U+0080 to U+009F) and
/// every byte that is no UTF-8 becomes "?".
std::string visible(std::string_view text);

/// A word of a command line as a shell takes it whole: in quotes where it needs them.
std::string shell_word(const std::string& word);

/// Hands everything on as visible() text. Keeps nothing back: what is written at once must be whole
/// characters.
class VisibleText final : public std::streambuf {
 public:
  /// @param onto outlives this
  explicit VisibleText(std::streambuf& onto) : onto_(onto) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int_type overflow(int_type letter) override;
  int sync() override { return onto_.pubsync(); }

 private:
  std::streambuf& onto_;
};

}  // namespace odomcalib
