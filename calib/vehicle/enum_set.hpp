// Sets of values of an enumeration that counts from 0 to 31 at most.
#pragma once

#include <initializer_list>

namespace odomcalib::calib::vehicle {

template <typename Enum>
class EnumSet {
 public:
  constexpr EnumSet() = default;
  constexpr EnumSet(std::initializer_list<Enum> values) {
    for (const Enum value : values) bits_ |= bit(value);
  }
  static constexpr EnumSet up_to(Enum last) {
    EnumSet set;
    set.bits_ = 2U * bit(last) - 1U;
    return set;
  }

  [[nodiscard]] constexpr bool contain(Enum value) const { return (bits_ & bit(value)) != 0; }
  constexpr EnumSet& operator|=(EnumSet others) {
    bits_ |= others.bits_;
    return *this;
  }
  [[nodiscard]] constexpr EnumSet without(EnumSet others) const {
    EnumSet set;
    set.bits_ = bits_ & ~others.bits_;
    return set;
  }
  friend constexpr bool operator==(EnumSet, EnumSet) = default;

 private:
  static constexpr unsigned bit(Enum value) { return 1U << static_cast<unsigned>(value); }
  unsigned bits_ = 0;
};

}  // namespace odomcalib::calib::vehicle
