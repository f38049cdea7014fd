// The slave's object dictionary (CiA 301): values, access rights, and hooks where reading or writing does
// something.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace odomcalib::sim {

using AbortCode = std::uint32_t;

namespace abort_code {
inline constexpr AbortCode kNone = 0;
inline constexpr AbortCode kToggle = 0x05030000;
inline constexpr AbortCode kCommand = 0x05040001;
inline constexpr AbortCode kWriteOnly = 0x06010001;
inline constexpr AbortCode kReadOnly = 0x06010002;
inline constexpr AbortCode kNoObject = 0x06020000;
inline constexpr AbortCode kNotMappable = 0x06040041;
inline constexpr AbortCode kPdoTooLong = 0x06040042;
inline constexpr AbortCode kIncompatible = 0x06040043;
inline constexpr AbortCode kHardware = 0x06060000;
inline constexpr AbortCode kLength = 0x06070010;
inline constexpr AbortCode kNoSubIndex = 0x06090011;
inline constexpr AbortCode kRange = 0x06090030;
inline constexpr AbortCode kCannotStore = 0x08000020;
inline constexpr AbortCode kState = 0x08000022;
}  // namespace abort_code

struct ObjectKey {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  friend auto operator<=>(const ObjectKey&, const ObjectKey&) = default;
};

enum class Access { read_only, read_write, constant };

struct Object {
  unsigned bytes = 4;  ///< 1, 2 or 4; 0 for text
  Access access = Access::read_only;
  bool mappable = false;
  std::uint32_t value = 0;
  std::string text;
  std::function<std::uint32_t()> computed;               ///< replaces `value` on reading
  std::function<AbortCode(std::uint32_t)> before_write;  ///< may refuse; the value is stored afterwards
  std::function<void(std::uint32_t)> after_write;
};

class ObjectDictionary {
 public:
  Object& add(ObjectKey key, Object object);
  Object& add_value(ObjectKey key, unsigned bytes, std::uint32_t value, Access access = Access::read_only);
  void add_text(ObjectKey key, std::string text);

  [[nodiscard]] bool contains(ObjectKey key) const { return objects_.contains(key); }
  [[nodiscard]] const Object* find(ObjectKey key) const;
  /// Current value as the slave itself sees it; 0 for unknown keys.
  [[nodiscard]] std::uint32_t value(ObjectKey key) const;
  /// Sets a value from inside, without checks and hooks.
  void set(ObjectKey key, std::uint32_t value);

  [[nodiscard]] std::variant<std::vector<std::uint8_t>, AbortCode> read(ObjectKey key) const;
  AbortCode write(ObjectKey key, std::span<const std::uint8_t> bytes);

 private:
  [[nodiscard]] AbortCode missing(ObjectKey key) const;

  std::map<ObjectKey, Object> objects_;
};

}  // namespace odomcalib::sim
