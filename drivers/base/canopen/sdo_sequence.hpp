// Several SDO transfers in a row, as data: what to read, what to write, what must be found afterwards.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/base/canopen/sdo_client.hpp"

namespace odomcalib::drivers::canopen {

struct SdoStep {
  enum class Kind { read, write, check } kind = Kind::read;
  ObjectAddress object;
  NumberType type;
  std::int64_t value = 0;  ///< write: what to write; check: what must be read
  bool optional = false;   ///< an abort or a difference is recorded and the sequence goes on
  double timeout_s = kSdoTimeout_s;
  std::string tag;   ///< finds the outcome again
  bool any = false;  ///< check: another value is none the worse, but is believed when it was read twice
  bool one_of_row = false;  ///< an error ends the row: what follows it of the row is left out
};

struct SdoOutcome {
  SdoStep step;
  std::vector<std::uint8_t> bytes;  ///< read, check
  std::int64_t value = 0;           ///< read, check: as a number of the step's type
  std::optional<std::uint32_t> abort;
  std::optional<Error> error;
};

/// Write and read back in one.
void add_checked_write(std::vector<SdoStep>& steps, const ObjectAddress& object, NumberType type,
                       std::int64_t value, bool optional = false, const std::string& tag = "");

/// A value, or a refusal, that is not what a check expects may be the late answer to an earlier request: it
/// is read again when none can come any more.
class SdoSequence {
 public:
  void start(std::vector<SdoStep> steps);
  void cancel();
  [[nodiscard]] bool running() const { return running_; }
  /// Takes the client's result and starts the next step. True once, when the sequence has ended.
  bool advance(SdoClient& client, double now);
  /// First error of a step that was not optional.
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] const std::vector<SdoOutcome>& outcomes() const { return outcomes_; }
  /// Last outcome with this tag, or nullptr.
  [[nodiscard]] const SdoOutcome* find(const std::string& tag) const;

 private:
  void note(const SdoResult& result);
  void leave_out_the_row();
  [[nodiscard]] bool to_be_confirmed(const SdoResult& result) const;

  std::vector<SdoStep> steps_;
  std::vector<SdoOutcome> outcomes_;
  std::optional<Error> error_;
  bool running_ = false;
  bool waiting_ = false;
  std::optional<double> again_at_;  ///< s, when the present step is tried again
};

}  // namespace odomcalib::drivers::canopen
