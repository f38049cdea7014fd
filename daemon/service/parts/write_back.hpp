// The way of values into the controller: one transaction at a time, its journal, its history, and the
// recovery of one that was interrupted.
#pragma once

#include <optional>
#include <string>

#include "daemon/service/control_server.hpp"
#include "daemon/writeback/drive_proof.hpp"
#include "daemon/writeback/history.hpp"
#include "daemon/writeback/journal.hpp"
#include "daemon/writeback/rounding.hpp"
#include "daemon/writeback/transaction.hpp"
#include "daemon/writeback/way_back.hpp"

namespace odomcalib {

/// Where a rollback is to go. Without an entry: one further back than the last one went.
struct WayWanted {
  std::string before, after;  ///< id of the entry before or after which; one of them, or neither
  bool replaced = false;      ///< the values of a former controller are for the one in its place
};

inline constexpr const char* kBeforeProof = "the values before those that wait for their proof";

/// Values that a rollback goes back to.
struct FormerValues {
  ParameterMap values;
  std::optional<std::string> calibration;  ///< JSON text; nullopt: none was in force
  std::string device;                      ///< whose they are, see device_of(); empty: not known
  std::string place;                       ///< where that is, in words
  std::string verified;  ///< newest entry with which this controller was seen to hold them; empty: none
  std::string restores;  ///< see Provenance
  bool proven = false;   ///< as that entry was
};

/// How a write-back has ended, for whoever asked for it.
struct WriteEnd {
  WriteReport report;
  std::optional<Error> unsettled;  ///< why the host goes on with the former calibration
};

class WriteBack {
  Journal journal_;  // first: the transaction writes to it

 public:
  /// @param disk outlives this
  WriteBack(Journal write_journal, const std::filesystem::path& state_dir, Background& disk);

  /// Reads and recovers when it is time for it, and goes on with what runs.
  /// @param may_begin the robot does not move. @return the end of a transaction
  std::optional<WriteReport> serve(drivers::Controller& controller, bool& values_known, bool may_begin,
                                   double now, std::int64_t wall_us);
  /// Begins one, see Transaction::write.
  /// @param prover client that will drive the proof; nullopt: the values are stored without one
  Result<void> write(const std::string& label, const ParameterMap& values, const std::string& calibration,
                     std::optional<ClientId> prover, Provenance origin);
  /// New values wait for the proof. The robot may move meanwhile, with them.
  [[nodiscard]] bool proving() const { return transaction.proving() && !not_proven_; }
  /// They wait until the axes are off, to be taken back.
  [[nodiscard]] bool going_back() const { return transaction.proving() && not_proven_; }
  /// They are proven, and are stored. Error: refused, none wait.
  Result<void> store();
  /// They are not: the old ones come back as soon as the axes are off.
  void take_back(const std::string& why);
  /// Values that this client was about to prove are not proven any more.
  void forget(ClientId gone);
  /// Learns from the end of a transaction what the controller holds.
  void learn(const WriteReport& report);
  /// From now on nothing is read or recovered any more.
  void end();
  /// The daemon ends.
  [[nodiscard]] bool ending() const { return ending_; }
  /// Until what it came to is in the history, too.
  [[nodiscard]] bool busy() const { return (transaction.busy() && !proving()) || settling; }
  /// Without an entry: what an unfinished write-back is to be taken back to, else one entry further back.
  /// @param device this controller. @param held what it holds, for its steps
  /// @param in_force JSON text of the calibration in force
  /// Errors: usage (no such entry, nothing further back), refused (values of another controller)
  [[nodiscard]] Result<FormerValues> former_values(const WayWanted& wanted, const std::string& device,
                                                   const std::vector<drivers::StoredParameter>& held,
                                                   const std::optional<std::string>& in_force) const;
  /// The newest committed entry where it is of another controller than this one, which then was replaced.
  [[nodiscard]] std::optional<HistoryEntry> of_former_controller(const std::string& device) const;
  /// Whether the values of the newest committed entry were proven; nullopt: there is none.
  [[nodiscard]] std::optional<bool> proven() const;
  /// Id of the calibration in the newest record of the journal.
  [[nodiscard]] std::string journaled_calibration() const;
  [[nodiscard]] const std::vector<JournalRecord>& journal_ends() const { return journal_.ends(); }
  [[nodiscard]] const std::vector<JournalDamage>& journal_damage() const { return journal_.damage(); }
  [[nodiscard]] std::optional<WriteEnd> take_end() { return std::exchange(ended, std::nullopt); }

  Transaction transaction;
  History history;
  bool operator_needed = false;
  std::string problem = "an interrupted write-back waits for the controller";  ///< operator_needed: why
  bool settling = false;   ///< its end is on the way to the disk
  RoundingError rounding;  ///< that the values of the newest write-back leave
  std::string place;       ///< where the newest one goes that is a rollback, in words; empty: it is none
  DriveProof proof;        ///< what was driven with the values in force
  std::vector<HistoryEntry> unwritten;  ///< entries that the disk did not take: the journal has them
  std::optional<WriteEnd> ended;
  double next_look = 0.0;  ///< s, at a history that cannot be listed

 private:
  void begin_reading(const drivers::Controller& controller, bool values_known, double now);
  void serve_proof(drivers::ControllerState state, bool may_begin, double now);

  [[nodiscard]] bool unfinished() const { return transaction.journal().unfinished().has_value(); }

  bool was_away_ = false;        // the controller, since its values were last asked for
  bool recovery_tried_ = false;  // since the controller was configured
  double next_recovery_ = 0.0;   // s
  double recovery_pause_;        // s
  bool ending_ = false;
  double next_read_ = 0.0;
  std::optional<ClientId> prover_;
  std::optional<Error> not_proven_;  // why the values that wait go back
  double proof_ends_ = 0.0;          // s, of the longest wait
};

}  // namespace odomcalib
