// Reading, writing and storing the geometry a controller holds, as sequences of SDO transfers.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "drivers/base/canopen/sdo_sequence.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

/// One job at a time. A write reads the old value first, writes, reads back and compares the raw numbers;
/// when that fails the old values are written back. A store is sent once and never repeated; everything is
/// read again after it, and where the profile says so once more after a reset of the node.
///
/// A request may reach the node late, and twice: nothing is written while an earlier write may still be under
/// way, and a value that is not the one last known is believed when it was read twice.
class ParameterJob {
 public:
  explicit ParameterJob(const Profile& profile) : profile_(profile), known_(profile.parameters.size()) {}

  [[nodiscard]] bool running() const { return running_; }
  [[nodiscard]] bool reading() const { return running_ && kind_ == ParameterJobResult::Kind::read; }
  /// A store keeps the drive busy for seconds: its life signs may then be late.
  [[nodiscard]] bool storing() const { return running_ && stage_ == Stage::store; }

  // Errors: refused (the profile names no such parameter or no store, value out of range).
  /// @param as_set_up checks of what else the node must hold; a difference ends the job with an error
  Result<void> start_read(std::vector<canopen::SdoStep> as_set_up = {});
  Result<void> start_write(const std::vector<ParameterValue>& values);
  Result<void> start_store();

  void advance(canopen::SdoClient& sdo, double now);
  /// True once, when the node is to be reset so that it shows what it stored; then it must be set up again.
  bool take_reset_request();
  void on_set_up_again();
  /// The node does not come back from that reset.
  [[nodiscard]] bool resetting() const { return running_ && stage_ == Stage::reset; }
  /// The node was lost: the job ends with an error that says what is known.
  void abandon();
  std::optional<ParameterJobResult> take_result();
  /// A setting that is not as it was set up, once.
  std::optional<Error> take_change() { return std::exchange(change_, std::nullopt); }

 private:
  enum class Stage { before, write, restore, store, after, reset, after_reset };
  struct Wanted {
    const ProfileParameter* parameter = nullptr;
    std::int64_t raw = 0;
    std::int64_t old_raw = 0;
  };

  void begin(ParameterJobResult::Kind kind);
  void start_reading(Stage stage, std::vector<canopen::SdoStep> steps = {});
  void start_writing(Stage stage);
  [[nodiscard]] std::size_t index_of(const ProfileParameter& parameter) const;
  [[nodiscard]] canopen::SdoStep reading_of(const ProfileParameter& parameter) const;
  void learn(Stage stage);
  void note_change();
  void start_storing();
  void end_stage();
  void after_reading_first();
  void after_writing();
  void after_restoring();
  void after_storing();
  void after_reading_again();
  void after_reading_after_reset();
  [[nodiscard]] bool reads_what_was_stored() const;
  void finish(std::optional<Error> error);
  [[nodiscard]] std::vector<StoredParameter> read_values() const;
  [[nodiscard]] Error failed(ErrorCode code, const std::string& what, const std::string& remedy) const;

  const Profile& profile_;
  canopen::SdoSequence sequence_;
  bool running_ = false;
  bool reset_wanted_ = false;
  double now_ = 0.0;
  double begins_at_ = -1e9;   ///< s, not before it does the present stage begin
  double settled_at_ = -1e9;  ///< s, when nothing that was written can be under way any more
  std::vector<std::optional<std::int64_t>> known_;  ///< raw, by parameter of the profile
  std::optional<Error> change_;
  Stage stage_ = Stage::before;
  ParameterJobResult::Kind kind_ = ParameterJobResult::Kind::read;
  std::vector<Wanted> wanted_;
  std::vector<StoredParameter> read_back_;
  std::optional<Error> first_error_;
  std::optional<ParameterJobResult> result_;
};

}  // namespace odomcalib::drivers
