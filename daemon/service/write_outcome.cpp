#include "daemon/service/write_outcome.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

void learn(RobotParts& parts, const WriteReport& report) {
  const bool certain = ending_of(report.outcome).certain;
  const bool was_read = !report.in_force.empty() || !report.error;
  // Where nothing was touched, it was a reading.
  const ParameterMap written = report.steps.empty() ? ParameterMap{} : report.before;
  if (!certain) parts.drive.forget_values();
  if (was_read) settle_reading(parts.drive, parts.outbox, report.in_force, written);
  parts.drive.values_known = certain && (parts.drive.values_known || was_read);
  parts.write_back.learn(report);
}

// A recovery that fails in the same way at every start tells nothing new, and must not push out what could be
// rolled back to.
bool known_already(const History& history, const HistoryEntry& entry) {
  if (entry.outcome != name_of(WriteOutcome::unknown) || history.entries().empty()) return false;
  const HistoryEntry& newest = history.entries().front();
  return newest.outcome == entry.outcome && newest.action == entry.action && newest.before == entry.before &&
         newest.after == entry.after;
}

/// The entry for the history; nullopt: nothing was touched, or it says so already.
std::optional<HistoryEntry> entry_of(const RobotParts& parts, const WriteReport& report) {
  if (report.steps.empty()) return std::nullopt;
  const History& history = parts.write_back.history;
  HistoryEntry entry{.id = report.origin.entry,
                     .time = parts.clock.wall_us(),
                     .action = report.label,
                     .outcome = name_of(report.outcome),
                     .calibration = std::nullopt,
                     .before = report.before,
                     .after = report.after,
                     .device = report.device,
                     .origin = report.origin};
  if (known_already(history, entry)) return std::nullopt;
  return entry.id.empty() ? history.numbered(std::move(entry)) : std::move(entry);
}

/// Records that an end leaves on the disk, filled in beside the loop.
struct Settlement {
  std::string calibration;  // id, see CalibrationInForce
  std::optional<HistoryEntry> entry;
  Result<void> noted, settled;
  Result<std::optional<Calibration>> in_force = std::optional<Calibration>();
};

void settle_on_disk(const History& history, const AppliedCalibration& applied, Settlement& end) {
  if (end.entry) {
    if (!end.calibration.empty()) end.entry->calibration = applied.file.announced(end.calibration);
    end.noted = history.write(*end.entry);
  }
  end.settled = applied.file.settle(end.calibration);
  end.in_force = applied.read();
}

/// @return why the host goes on with the former calibration although the controller has the values of this
/// one
std::optional<Error> take_over(RobotParts& parts, const Settlement& end) {
  Outbox& outbox = parts.outbox;
  // The journal has it, whether its file could be written or not.
  if (end.entry) parts.write_back.history.keep(*end.entry);
  if (end.entry && !end.noted) parts.write_back.unwritten.push_back(*end.entry);
  if (!end.noted) outbox.event(messages::Severity::warning, "history", end.noted.error().text());
  parts.applied.take(end.in_force);
  if (!end.in_force) outbox.event(messages::Severity::warning, "active", end.in_force.error().text());
  if (end.settled) return std::nullopt;
  const Error& why = end.settled.error();
  outbox.event(messages::Severity::fault, "active", why.text());
  return Error{
      why.code,
      "the values are in the controller, but corrected odometry goes on with the former calibration (" +
          why.what + ")",
      why.where, why.remedy + "; then apply again"};
}

void tell_unreadable(RobotParts& parts) {
  for (const std::filesystem::path& path : parts.write_back.history.unreadable())
    parts.outbox.event(messages::Severity::warning, "history",
                       path.string() + ": holds no write-back that can be read; rollback passes over it");
}

/// The result of a look at the history, filled in beside the loop.
struct Look {
  std::optional<History> found;
  std::vector<HistoryEntry> unwritten;  ///< that the disk has not taken before
  std::set<std::string> written;        ///< ids of those that are there now
};

void take_over(RobotParts& parts, Look look) {
  WriteBack& values = parts.write_back;
  values.next_look = parts.now + service::settings::kLookAgain_s;
  // An end that is on its way to the disk has begun to ask the history whether it can be listed.
  if (look.found->unlisted() || values.settling) return;
  const std::string folder = look.found->folder().string();
  std::erase_if(values.unwritten, [&](const HistoryEntry& one) { return look.written.contains(one.id); });
  values.history.take_over(std::move(*look.found));
  parts.outbox.event(
      messages::Severity::info, "history",
      fmt::format("{}: can be read again; write-backs in it: {}", folder, values.history.entries().size()));
  tell_unreadable(parts);
}

}  // namespace

void settle_reading(Drive& drive, Outbox& outbox, const std::vector<drivers::StoredParameter>& found,
                    const ParameterMap& written) {
  if (drive.take(found, written))
    outbox.event(messages::Severity::warning, "values_changed", drive.changed_besides({})->text());
  drive.values_known = true;
  outbox.send_robot_soon();
}

void settle_write(RobotParts& parts, const WriteReport& report) {
  learn(parts, report);
  const Ending& how = ending_of(report.outcome);
  if (!how.of_a_write) return;
  parts.outbox.event(how.as_asked ? messages::Severity::info : messages::Severity::fault, "write_back",
                     how.name + (report.error ? ": " + report.error->text() : ""));
  // Nothing of it lasts yet: neither the history nor the calibration in force changes.
  if (!how.lasts) {
    parts.write_back.ended = WriteEnd{report, std::nullopt};
    return;
  }
  const auto end = std::make_shared<Settlement>();
  end->calibration = how.as_asked ? report.calibration : "";
  end->entry = entry_of(parts, report);
  parts.write_back.settling = true;
  parts.disk->post([&history = parts.write_back.history, &applied = parts.applied,
                    end] { settle_on_disk(history, applied, *end); },
                   [&parts, report, end] {
                     parts.write_back.settling = false;
                     parts.write_back.ended = WriteEnd{report, take_over(parts, *end)};
                   });
}

void settle_from_journal(RobotParts& parts) {
  WriteBack& values = parts.write_back;
  for (const JournalRecord& record : values.history.missing(values.journal_ends())) {
    Settlement end;
    end.entry = entry_of(record);
    const bool committed = record.state == JournalState::commit;
    if (committed) end.entry->calibration = parts.applied.file.announced(record.calibration);
    if (!parts.folder.read_only()) end.noted = values.history.write(*end.entry);
    values.history.keep(*end.entry);
    if (!end.noted) values.unwritten.push_back(*end.entry);
  }
  for (const JournalDamage& damage : values.journal_damage())
    parts.outbox.event(messages::Severity::warning, "journal", to_text(damage));
  if (const auto& why = values.history.unlisted())
    parts.outbox.event(messages::Severity::warning, "history", why->text());
  tell_unreadable(parts);
  const auto& last = values.transaction.journal().last();
  Settlement end;
  end.calibration = last && last->state == JournalState::commit ? last->calibration : "";
  settle_on_disk(values.history, parts.applied, end);
  (void)take_over(parts, end);
}

void look_again_at_history(RobotParts& parts) {
  WriteBack& values = parts.write_back;
  const bool waits = values.busy() || values.proving() || values.ending();
  if (!values.history.unlisted() || waits || parts.now < values.next_look) return;
  values.next_look = std::numeric_limits<double>::infinity();  // until it is done
  const auto look = std::make_shared<Look>(Look{std::nullopt, values.unwritten, {}});
  parts.disk->post(
      [look, folder = values.history.folder()] {
        const History& found = look->found.emplace(folder);
        if (found.unlisted()) return;
        for (const HistoryEntry& entry : look->unwritten)
          if (found.knows(entry) || found.write(entry)) look->written.insert(entry.id);
      },
      [&parts, look] { take_over(parts, std::move(*look)); });
}

}  // namespace odomcalib
