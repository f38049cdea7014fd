#include "daemon/service/parts/write_back.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

bool away(drivers::ControllerState state) {
  return state == drivers::ControllerState::absent || state == drivers::ControllerState::configuring;
}

}  // namespace

WriteBack::WriteBack(Journal write_journal, const std::filesystem::path& state_dir, Background& disk)
    : journal_(std::move(write_journal)),
      transaction(journal_, disk),
      history(state_dir / "history"),
      operator_needed(unfinished()),
      recovery_pause_(service::settings::kRecoverAgain_s) {}

std::optional<WriteReport> WriteBack::serve(drivers::Controller& controller, bool& values_known,
                                            bool may_begin, double now, std::int64_t wall_us) {
  const auto state = controller.state();
  was_away_ = was_away_ || away(state);
  serve_proof(state, may_begin, now);
  // When the controller comes back, it and the values it holds are to be seen, at once: nothing moves before.
  if (was_away_ && !busy()) {
    was_away_ = values_known = recovery_tried_ = false;
    if (!ending_) next_read_ = now;
  }
  if (state == drivers::ControllerState::disabled && !busy() && may_begin && now >= next_read_)
    begin_reading(controller, values_known, now);
  transaction.step(controller, now, wall_us);
  return transaction.take_report();
}

// Values in RAM are as fleeting as the one who wanted them proven: what ends the one ends the other.
void WriteBack::serve_proof(drivers::ControllerState state, bool may_begin, double now) {
  if (!transaction.proving()) {
    proof_ends_ = now + service::settings::kLongestProof_s;
    return;
  }
  if (was_away_) take_back("the controller was away");
  if (now >= proof_ends_) take_back("the proof took too long");
  if (not_proven_ && may_begin && state == drivers::ControllerState::disabled)
    (void)transaction.conclude(*not_proven_, proof.trial());
}

Result<void> WriteBack::store() {
  if (!not_proven_) return transaction.conclude({}, proof.trial());
  return *not_proven_;
}

void WriteBack::take_back(const std::string& why) {
  if (transaction.busy() && prover_ && !not_proven_)
    not_proven_ = {ErrorCode::write_failed, "not proven: " + why, "proof run", "calibrate again"};
}

void WriteBack::forget(ClientId gone) {
  if (prover_ == gone) take_back("whoever drove the proof has left");
}

// One recovery each time the controller was configured: each may store once, and permanent memory wears out.
// After it only reads are repeated. It waits for rest, reading alone does not.
void WriteBack::begin_reading(const drivers::Controller& controller, bool values_known, double now) {
  const bool recover = operator_needed && !recovery_tried_ && now >= next_recovery_;
  if (recover ? !controller.at_rest() : values_known) return;
  // Who writes to it now would do so while it is read.
  if (const auto touched = controller.touched();
      touched && now - *touched < service::settings::kOthersQuiet_s)
    return;
  next_read_ = now + service::settings::kReadAgain_s;
  if (recover) {
    next_recovery_ = now + recovery_pause_;
    recovery_pause_ = std::min(2.0 * recovery_pause_, service::settings::kLongestRecoverAgain_s);
  }
  (void)(recover ? transaction.recover() : transaction.read());
}

Result<void> WriteBack::write(const std::string& label, const ParameterMap& values,
                              const std::string& calibration, std::optional<ClientId> prover,
                              Provenance origin) {
  if (settling) return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  // With the id that its entry will have, the journal alone says afterwards what became of it.
  origin.entry = history.numbered({}).id;
  auto begun = transaction.write(label, values, calibration, prover ? Proof::wanted : Proof::none, origin);
  if (!begun) return begun;
  ended.reset();
  prover_ = prover;
  not_proven_.reset();
  return begun;
}

void WriteBack::learn(const WriteReport& report) {
  const Ending& end = ending_of(report.outcome);
  // Each drive was driven with the values in force at its time.
  if (end.proof != nullptr) (proof.*end.proof)();
  recovery_tried_ = recovery_tried_ || !end.certain;
  if (end.lasts && end.certain) {
    next_recovery_ = 0.0;
    recovery_pause_ = service::settings::kRecoverAgain_s;
  }
  operator_needed = !end.certain || (!end.of_a_write && unfinished());
  if (operator_needed && report.error) problem = report.error->text();
}

void WriteBack::end() {
  ending_ = true;
  take_back("the daemon ends");
  next_read_ = std::numeric_limits<double>::infinity();
}

std::string WriteBack::journaled_calibration() const {
  const auto& last = transaction.journal().last();
  return last ? last->calibration : "";
}

namespace {

std::string lengths_text(const ParameterMap& values) {
  std::string text;
  for (const auto& [name, value] : values)
    text += fmt::format("{}{} {:.3f} mm", text.empty() ? "" : ", ", name, 1e3 * value);
  return text;
}

/// Former values belong to the controller that held them. One that does not say who it is is believed.
bool of_another(const HistoryEntry& entry, const std::string& device) {
  return !entry.device.empty() && !device.empty() && entry.device != device;
}

Error of_another_controller(const HistoryEntry& entry, const std::string& ours, const WayBack& theirs) {
  const HistoryEntry& last = *theirs.newest();
  return {ErrorCode::refused,
          fmt::format("entry {} is of the controller \"{}\", this one is \"{}\": was it replaced? The last "
                      "values verified on that one are {}",
                      entry.id, entry.device, ours, lengths_text(theirs.after(last))),
          "rollback",
          "odomcalibctl rollback --to " + last.id +
              " --replaced writes them to this one; or connect that controller"};
}

/// The values in force then were never lost in full: they need no other proof.
Result<FormerValues> before_interrupted(const JournalRecord& record, const std::string& device,
                                        const std::optional<std::string>& in_force) {
  if (!record.device.empty() && !device.empty() && record.device != device)
    return Error{ErrorCode::refused,
                 fmt::format("the interrupted {} was to the controller \"{}\", this one is \"{}\"",
                             record.label, record.device, device),
                 "rollback", "connect that controller, or apply a calibration to this one"};
  FormerValues former;
  former.values = record.before;
  former.calibration = in_force;
  former.device = record.device;
  former.place = "the values before the interrupted " + record.label;
  former.verified = "journal";
  return former;
}

/// A place on the way back.
struct Stage {
  const HistoryEntry& entry;
  bool after;    ///< the values of the entry, not those before it
  bool foreign;  ///< the entry is of the controller that was there before
};

std::string place_of(const Stage& stage, const HistoryEntry* seen) {
  return (stage.after ? "the values of entry " : "the values before entry ") + stage.entry.id +
         (seen != nullptr && seen->id != stage.entry.id ? ", verified as entry " + seen->id : "") +
         (stage.foreign ? ", verified on the controller \"" + stage.entry.device + "\"" : "");
}

/// In force after an entry is the calibration that it, or the newest older one, has put in force; a rollback
/// may have put it out of force.
std::optional<std::string> calibration_after(const WayBack& way, const HistoryEntry* entry) {
  while (entry != nullptr && !entry->calibration && entry->origin.restores.empty())
    entry = way.older_than(entry->id);
  return entry != nullptr ? entry->calibration : std::nullopt;
}

FormerValues values_at(const WayBack& way, const Stage& stage,
                       const std::vector<drivers::StoredParameter>& held) {
  const HistoryEntry& entry = stage.entry;
  const HistoryEntry* const following = stage.after ? way.following(entry) : &entry;
  const HistoryEntry* const source = stage.after ? &entry : way.older_than(entry.id);
  FormerValues former;
  former.values = stage.after ? way.after(entry) : way.before(entry);
  former.device = entry.device;
  former.calibration = calibration_after(way, source);
  former.proven = source != nullptr && source->origin.proven && !stage.foreign;
  if (!stage.foreign && following != nullptr) former.restores = following->id;
  const HistoryEntry* const seen = stage.foreign ? nullptr : way.verified(former.values, held);
  if (seen != nullptr) former.verified = seen->id;
  former.place = place_of(stage, seen);
  return former;
}

/// @param id empty: of any
Error no_entry(const History& history, const std::string& id) {
  constexpr const char* kSee = "odomcalibctl history";
  const auto& damaged = history.unreadable();
  const auto own = std::ranges::find_if(damaged, [&](const auto& file) { return file.stem() == id; });
  if (own != damaged.end())
    return {ErrorCode::usage, "history entry \"" + id + "\" cannot be read", own->string(), kSee};
  if (!id.empty()) return {ErrorCode::usage, "no history entry \"" + id + "\" that was committed", "", kSee};
  if (damaged.empty()) return {ErrorCode::usage, "no write-back was committed", "", kSee};
  return {ErrorCode::usage,
          fmt::format("no write-back that can be read was committed, and {} cannot", damaged.size()),
          damaged.front().parent_path().string(), kSee};
}

}  // namespace

std::optional<HistoryEntry> WriteBack::of_former_controller(const std::string& device) const {
  auto newest = history.newest_committed();
  return newest && of_another(*newest, device) ? newest : std::nullopt;
}

std::optional<bool> WriteBack::proven() const {
  const auto newest = history.newest_committed();
  return newest ? std::optional(newest->origin.proven) : std::nullopt;
}

// One that was rolled back or ended unknown has put nothing in force that could be taken back.
Result<FormerValues> WriteBack::former_values(const WayWanted& wanted, const std::string& device,
                                              const std::vector<drivers::StoredParameter>& held,
                                              const std::optional<std::string>& in_force) const {
  const std::string& named = wanted.before.empty() ? wanted.after : wanted.before;
  const auto interrupted = transaction.journal().unfinished();
  if (named.empty() && interrupted && !interrupted->before.empty() && !wanted.replaced)
    return before_interrupted(*interrupted, device, in_force);
  // The newest entry of a part of the history is any entry, and so is the one before it.
  if (history.unlisted()) return *history.unlisted();
  const auto found = named.empty() ? history.newest_committed() : history.find(named);
  if (!found || found->outcome != name_of(WriteOutcome::committed)) return no_entry(history, named);
  const bool foreign = of_another(*found, device);
  const WayBack way(history.entries(), foreign ? found->device : device);
  if (foreign && !wanted.replaced) return of_another_controller(*found, device, way);
  const HistoryEntry* entry = named.empty() && !foreign ? way.next() : &*found;
  if (entry == nullptr)
    return Error{ErrorCode::usage, "nothing is further back: the oldest values of the history are in force",
                 "", "odomcalibctl history; rollback --to ID goes to the values of an entry"};
  return values_at(way, {*entry, !wanted.after.empty() || (named.empty() && foreign), foreign}, held);
}

}  // namespace odomcalib
