// Writing parameters so that a crash or a power failure at any moment leaves wholly old or wholly new values:
// read, journal, write RAM, compare, prove by a motion where that is wanted, journal, store once, compare,
// commit; otherwise everything back.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/writeback/journal_writer.hpp"
#include "daemon/writeback/outcome.hpp"
#include "drivers/base/controller.hpp"

namespace odomcalib {

using ParameterMap = std::map<std::string, double>;  ///< SI, by quantity

/// Whether new values are stored at once, or after a motion with them.
enum class Proof { none, wanted };

struct WriteReport {
  WriteOutcome outcome = WriteOutcome::unknown;
  std::string label;
  std::vector<drivers::StoredParameter> in_force;  ///< newest reading, empty when nothing could be read
  ParameterMap before, after;                      ///< after: what was asked for
  std::string device;                              ///< who holds them, see device_of(); empty: not known
  std::string calibration;                         ///< id of the one in force with `after`
  Provenance origin;
  std::optional<Error> error;      ///< why it was not committed
  std::vector<std::string> steps;  ///< what was journaled; empty: nothing was touched
};

/// Drives one controller through one transaction at a time. Holds no clock and no descriptor.
class Transaction {
 public:
  /// @param journal, background outlive the transaction; a record is on the disk before the action that it
  /// announces begins, and the controller's bus is served meanwhile
  explicit Transaction(Journal& journal, Background& background = foreground())
      : journal_(journal, background) {}

  // One of these starts; refused (error refused) while another one runs.
  Result<void> read();
  /// Reads, and brings an unfinished write-back of the journal to an end by comparing what the controller
  /// holds: all new is stored and committed, anything else becomes old again. Another controller than the one
  /// in the journal, and values that the journal does not name, are left alone (outcome unknown).
  Result<void> recover();
  /// Writes those of the values that the controller stores, in full or not at all. While the journal is
  /// unfinished, what counts as old is what the journal says, and all of its quantities must be among the
  /// values: what the controller holds may be a mixture.
  /// @param calibration id of the one that is in force with these values (see CalibrationInForce)
  /// @param origin is kept with what becomes of them
  Result<void> write(const std::string& label, const ParameterMap& values,
                     const std::string& calibration = "", Proof proof = Proof::none,
                     const Provenance& origin = {});

  /// New values wait for their proof: there was a report of them, and there will be one of their end.
  [[nodiscard]] bool proving() const { return phase_ == Phase::proving && !proof_; }
  /// Ends that: a value stores them, an error says why the old ones come back. Error: refused, none wait.
  /// @param trial is kept with what becomes of them
  Result<void> conclude(const Result<void>& proof, const DriveTrial& trial = {});

  /// Call every few ms.
  void step(drivers::Controller& controller, double now, std::int64_t wall_us);
  [[nodiscard]] bool busy() const { return phase_ != Phase::idle; }
  /// Once, when it has ended, and once before that where new values wait for their proof.
  std::optional<WriteReport> take_report();
  /// The journal on the disk.
  [[nodiscard]] const JournalWriter& journal() const { return journal_; }

 private:
  enum class Task { read, recover, write };
  enum class Phase {
    idle,
    read_first,
    write_new,
    proving,
    store_new,
    verify_new,
    write_old,
    store_old,
    verify_old
  };
  enum class After { write_new, prove, store_new, commit, write_old, report };  // what records announce
  using Job = drivers::ParameterJobResult;

  Result<void> begin(Task task, const std::string& label);
  void start(Phase phase);
  [[nodiscard]] bool controller_there() const;
  [[nodiscard]] bool waits_for_controller();
  bool again_when_back(const Job& job, Phase phase);
  void start_when_at_rest();
  Result<void> start_job() const;
  [[nodiscard]] Job::Kind kind() const;
  [[nodiscard]] bool about_this_device() const;
  void on_result(const Job& job);
  void on_read(const Job& job);
  void on_written(const Job& job);
  void on_proof();
  void keep(std::deque<JournalState> states);
  void on_verified(const Job& job);
  void on_old_written(const Job& job);
  void on_old_verified(const Job& job);
  void decide_recovery();
  void store_again();
  void not_begun(const Error& why);
  void plan_write();
  void take_old_from_journal();
  void begin_writing();
  void go_back(const Error& why);
  /// `after` follows when all of the records are on the disk.
  void announce(std::deque<JournalState> states, After after);
  void go_on_announcing();
  void not_announced(const Error& why);
  void proceed(After after);
  [[nodiscard]] JournalRecord record_of(JournalState state) const;
  void leave_alone(const Error& why);
  void finish(WriteOutcome outcome);
  void report();

  JournalWriter journal_;
  Phase phase_ = Phase::idle;
  Task task_ = Task::read;
  bool started_ = false;                // the job of this phase runs
  std::deque<JournalState> announced_;  // records that are not on the disk yet, the first is on its way
  bool announcing_ = false;             // `after_` waits for them
  After after_ = After::report;
  bool store_begun_ = false;   // permanent memory may hold other values than the old ones
  bool stored_again_ = false;  // the old values were to be stored once already
  bool old_known_ = true;      // the old values are a whole set, not what was read of a mixture
  bool unproven_ = false;      // the new values are to be proven before they are stored
  std::optional<Result<void>> proof_;
  double entered_ = 0.0;
  double away_ = 0.0;      // s, when the controller was last seen to be away
  double answered_ = 0.0;  // s, and when it answered meanwhile
  int returns_ = 0;        // jobs of the way back that it left
  // Controller and times of the present step.
  drivers::Controller* controller_ = nullptr;
  double now_ = 0.0;
  std::int64_t wall_us_ = 0;
  std::optional<JournalRecord> interrupted_;  // that the journal was left with
  WriteReport report_;
  std::optional<WriteReport> finished_;
};

/// Who the controller is, as far as it says: vendor/product/serial (1018h) or name of each of its devices.
std::string device_of(const drivers::Controller& controller);

/// All of `wanted`, each within half a step of the controller's resolution. Nobody holds an empty set.
bool holds(const std::vector<drivers::StoredParameter>& stored, const ParameterMap& wanted);

}  // namespace odomcalib
