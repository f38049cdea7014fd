// SDO server (CiA 301): expedited and segmented transfers, one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "tests/sim/wires/object_dictionary.hpp"

namespace odomcalib::sim {

using SdoBytes = std::array<std::uint8_t, 8>;

/// Switches for tests.
struct SdoFaults {
  bool silent = false;       ///< requests are not answered
  bool wrong_index = false;  ///< answers name another object
  std::map<ObjectKey, AbortCode> abort_on_write;
  std::map<ObjectKey, AbortCode> abort_on_read;
  std::map<ObjectKey, std::uint32_t> read_back;  ///< value answered instead of the real one
  std::map<ObjectKey, double> answer_delay;      ///< s, added to the answer of this object
};

class SdoServer {
 public:
  explicit SdoServer(ObjectDictionary& dictionary) : dictionary_(dictionary) {}

  /// Answer to one request, or nothing when none is due (a client's abort, or a silent server).
  std::optional<SdoBytes> answer(const SdoBytes& request);
  /// Object of the last request, e.g. to know how long it takes.
  [[nodiscard]] ObjectKey last_key() const { return last_key_; }
  SdoFaults faults;

 private:
  enum class Transfer { none, upload, download };

  SdoBytes start_download(const SdoBytes& request);
  SdoBytes download_segment(const SdoBytes& request);
  SdoBytes start_upload();
  SdoBytes upload_segment(const SdoBytes& request);
  SdoBytes abort(AbortCode code);
  [[nodiscard]] SdoBytes reply(std::uint8_t command) const;
  AbortCode write(std::span<const std::uint8_t> bytes);

  ObjectDictionary& dictionary_;
  ObjectKey last_key_;
  Transfer transfer_ = Transfer::none;
  std::vector<std::uint8_t> buffer_;
  std::size_t announced_ = 0, done_ = 0;
  std::uint8_t toggle_ = 0;
};

}  // namespace odomcalib::sim
