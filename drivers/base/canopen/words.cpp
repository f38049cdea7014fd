#include "drivers/base/canopen/words.hpp"

#include <array>
#include <cstdio>
#include <span>

namespace odomcalib::drivers::canopen {
namespace {

struct Word {
  std::uint32_t code;
  const char* text;
};

// CiA 301 table "SDO abort codes"
constexpr std::array<Word, 31> kAborts = {{
    {0x05030000, "toggle bit not alternated"},
    {0x05040000, "protocol timed out"},
    {0x05040001, "command specifier unknown"},
    {0x05040002, "invalid block size"},
    {0x05040003, "invalid sequence number"},
    {0x05040004, "CRC error"},
    {0x05040005, "out of memory"},
    {0x06010000, "unsupported access"},
    {0x06010001, "read of a write-only object"},
    {0x06010002, "write of a read-only object"},
    {0x06020000, "object does not exist"},
    {0x06040041, "object cannot be mapped"},
    {0x06040042, "mapping exceeds PDO length"},
    {0x06040043, "parameter incompatibility"},
    {0x06040047, "internal incompatibility"},
    {0x06060000, "hardware error"},
    {0x06070010, "type or length does not match"},
    {0x06070012, "length too high"},
    {0x06070013, "length too low"},
    {0x06090011, "sub-index does not exist"},
    {0x06090030, "value out of range"},
    {0x06090031, "value too high"},
    {0x06090032, "value too low"},
    {0x06090036, "maximum less than minimum"},
    {0x060A0023, "resource not available"},
    {0x08000000, "general error"},
    {0x08000020, "cannot transfer or store"},
    {0x08000021, "cannot transfer or store: local control"},
    {0x08000022, "cannot transfer or store in the present device state"},
    {0x08000023, "no object dictionary"},
    {0x08000024, "no data available"},
}};

constexpr std::array<Word, 20> kEmergencies = {{
    {0x0000, "error gone"},
    {0x2310, "continuous over-current"},
    {0x2320, "short circuit"},
    {0x3210, "over-voltage"},
    {0x3220, "under-voltage"},
    {0x4210, "device too hot"},
    {0x4310, "drive too hot"},
    {0x5530, "non-volatile memory"},
    {0x6320, "parameter error"},
    {0x7121, "motor blocked"},
    {0x7305, "incremental encoder 1"},
    {0x7306, "incremental encoder 2"},
    {0x8110, "CAN overrun"},
    {0x8120, "CAN error passive"},
    {0x8130, "heartbeat or guarding lost"},
    {0x8140, "recovered from bus-off"},
    {0x8150, "COB-ID collision"},
    {0x8210, "PDO too short"},
    {0x8250, "RPDO time-out"},
    {0x8611, "following error"},
}};

constexpr std::array<Word, 10> kEmergencyGroups = {{
    {0x1000, "generic error"},
    {0x2000, "current"},
    {0x3000, "voltage"},
    {0x4000, "temperature"},
    {0x5000, "hardware"},
    {0x6000, "software"},
    {0x7000, "motor, sensor or module"},
    {0x8000, "monitoring"},
    {0x9000, "external error (emergency stop input)"},
    {0xF000, "vendor-specific error"},
}};

const char* find(std::span<const Word> words, std::uint32_t code) {
  for (const Word& word : words)
    if (word.code == code) return word.text;
  return nullptr;
}

std::string with_code(const char* text, std::uint32_t code, int digits) {
  std::array<char, 16> number{};
  const int n = std::snprintf(number.data(), number.size(), "%0*Xh", digits, code);
  return std::string(text) + " (" + std::string(number.data(), static_cast<std::size_t>(n > 0 ? n : 0)) + ")";
}

}  // namespace

std::string abort_text(std::uint32_t code) {
  const char* text = find(kAborts, code);
  return with_code(text != nullptr ? text : "unknown abort code", code, 8);
}

std::string emergency_text(std::uint16_t code) {
  const char* text = find(kEmergencies, code);
  if (text == nullptr) text = find(kEmergencyGroups, code & 0xF000u);
  return with_code(text != nullptr ? text : "unknown emergency code", code, 4);
}

std::string nmt_state_text(std::uint8_t state) {
  switch (state) {
    case 0x00:
      return "boot-up";
    case 0x04:
      return "stopped";
    case 0x05:
      return "operational";
    case 0x7F:
      return "pre-operational";
    default:
      return "unknown state";
  }
}

}  // namespace odomcalib::drivers::canopen
