#include "drivers/base/cia402/node_setup.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/base/canopen/words.hpp"
#include "drivers/base/cia402/drive_state.hpp"
#include "drivers/base/cia402/settings.hpp"
#include "drivers/clean_text.hpp"

namespace odomcalib::drivers {
namespace {

using namespace cia402;

using canopen::NumberType;
using canopen::SdoStep;
constexpr std::uint8_t kOperationalState = 0x05;
constexpr NumberType kU16{2, false};
constexpr NumberType kU32{4, false};
constexpr NumberType kI16{2, true};
constexpr NumberType kI32{4, true};

SdoStep read_step(std::uint16_t index, std::uint8_t sub, NumberType type, bool optional,
                  const std::string& tag) {
  return {SdoStep::Kind::read, {index, sub}, type, 0, optional, canopen::kSdoTimeout_s, tag};
}

SdoStep write_step(const canopen::ObjectAddress& object, NumberType type, std::int64_t value, bool optional) {
  return {SdoStep::Kind::write, object, type, value, optional, canopen::kSdoTimeout_s, ""};
}

void add_watchdog(std::vector<SdoStep>& steps, const Profile& profile) {
  const ProfileWatchdog& watchdog = profile.watchdog;
  if (watchdog.kind == ProfileWatchdog::Kind::none) return;
  const auto counts = std::int64_t{std::llround(watchdog.time_ms / watchdog.unit_ms)};
  const bool consumer = watchdog.kind == ProfileWatchdog::Kind::heartbeat_consumer;
  const std::int64_t value = consumer ? (std::int64_t{profile.host_node} << 16 | counts) : counts;
  add_checked_write(steps, watchdog.object, watchdog.type, value, true, "watchdog");
  for (const ProfileWrite& also : watchdog.also)
    add_checked_write(steps, also.object, also.type, also.value, true, "watchdog");
}

void add_rest(std::vector<SdoStep>& steps, const Profile& profile) {
  // An earlier master may have left the axes enabled with a target.
  steps.push_back(write_step(profile.speed_left, kI32, 0, true));
  if (profile.axes == 2) steps.push_back(write_step(profile.speed_right, kI32, 0, true));
  steps.push_back(write_step(profile.control, kU16, canopen::kDisableVoltage, true));
}

void add_safety_readings(std::vector<SdoStep>& steps) {
  steps.push_back(read_step(0x605A, 0, kI16, true, "605A"));
  steps.push_back(read_step(0x605B, 0, kI16, true, "605B"));
  steps.push_back(read_step(0x605D, 0, kI16, true, "605D"));
  steps.push_back(read_step(0x605E, 0, kI16, true, "605E"));
}

/// Readings of the node's other receive PDOs, one after the other until it has no more.
void add_receive_pdo_readings(std::vector<SdoStep>& steps) {
  for (std::uint16_t number = 0; number < kMostReceivePdos; ++number) {
    SdoStep step = read_step(static_cast<std::uint16_t>(0x1400 + number), 1, kU32, true, "rpdo");
    step.one_of_row = true;
    steps.push_back(std::move(step));
  }
}

/// Those of them that the profile does not list: what is read of 1400h ff.
std::vector<canopen::SdoOutcome> unlisted_pdos(const Profile& profile,
                                               std::vector<canopen::SdoOutcome> outcomes) {
  const auto listed = [&](const canopen::SdoOutcome& outcome) {
    return std::any_of(profile.pdos.begin(), profile.pdos.end(), [&](const canopen::Pdo& pdo) {
      return !pdo.transmit && 0x1400 + pdo.number - 1 == outcome.step.object.index;
    });
  };
  std::erase_if(outcomes, [&](const canopen::SdoOutcome& outcome) {
    return outcome.step.tag != "rpdo" || outcome.error || listed(outcome);
  });
  return outcomes;
}

void add_disabling(std::vector<SdoStep>& steps, const canopen::SdoOutcome& pdo) {
  const std::int64_t disabled = pdo.value | std::int64_t{canopen::kPdoDisabled};
  if (pdo.value != disabled) steps.push_back(write_step(pdo.step.object, kU32, disabled, true));
  steps.push_back(
      {SdoStep::Kind::check, pdo.step.object, kU32, disabled, true, canopen::kSdoTimeout_s, "unlisted"});
}

std::vector<SdoStep> configuration(const Profile& profile, const std::vector<canopen::SdoOutcome>& unlisted) {
  std::vector<SdoStep> steps;
  add_rest(steps, profile);
  for (const canopen::SdoOutcome& pdo : unlisted) add_disabling(steps, pdo);
  for (const ProfileWrite& init : profile.init) add_checked_write(steps, init.object, init.type, init.value);
  add_safety_readings(steps);
  const auto heartbeat = std::int64_t{std::llround(profile.heartbeat_ms / profile.heartbeat_unit_ms)};
  add_checked_write(steps, {0x1017, 0}, kU16, heartbeat);
  add_watchdog(steps, profile);
  if (profile.mode) {
    steps.push_back(write_step(profile.mode->object, profile.mode->type, profile.mode->value, false));
    steps.push_back({SdoStep::Kind::check, profile.mode_display, profile.mode->type, profile.mode->value,
                     true, canopen::kSdoTimeout_s, "mode"});
  }
  for (const canopen::Pdo& pdo : profile.pdos) add_pdo_configuration(steps, pdo);
  return steps;
}

}  // namespace

NodeSetup::Step NodeSetup::advance(canopen::SdoClient& sdo, const Seen& seen, double now) {
  now_ = now;
  if (phase_ == Phase::absent) {
    look_for_node(sdo, seen.other_master);
    return Step::none;
  }
  if (phase_ == Phase::starting) return check_started(seen);
  if (!sequence_.advance(sdo, now_)) return Step::none;
  if (phase_ == Phase::identifying) return end_identification(sdo);
  return phase_ == Phase::configuring ? end_configuration() : Step::none;
}

void NodeSetup::begin_again(double now, double pause) {
  now_ = now;
  sequence_.cancel();
  enter(Phase::absent);
  watchdog_armed_ = false;
  look_after_ = now_ + pause;
}

bool NodeSetup::receives(std::uint32_t cob_id) const {
  return std::any_of(unlisted_.begin(), unlisted_.end(),
                     [&](const auto& pdo) { return (pdo.value & canopen::kPdoIdentifier) == cob_id; });
}

void NodeSetup::event(const std::string& code, const std::string& text, bool stop) {
  events_.push_back({now_, code, text, stop});
}

void NodeSetup::enter(Phase phase) {
  phase_ = phase;
  phase_since_ = now_;
}

void NodeSetup::send_nmt(std::uint8_t command) {
  CanFrame frame;
  frame.id = 0x000;
  frame.length = 2;
  frame.data = {command, profile_.node};
  out_.push_back(frame);
}

void NodeSetup::look_for_node(canopen::SdoClient& sdo, bool other_master) {
  if (!look_after_) look_after_ = now_ + kListen_s;
  if (now_ >= *look_after_ && !other_master) begin_identification(sdo);
}

void NodeSetup::begin_identification(canopen::SdoClient& sdo) {
  enter(Phase::identifying);
  sdo.cancel();
  std::vector<SdoStep> steps = {
      read_step(0x1018, 1, kU32, false, "vendor"), read_step(0x1018, 2, kU32, false, "product"),
      read_step(0x1018, 3, kU32, true, "revision"), read_step(0x1018, 4, kU32, true, "serial"),
      read_step(0x1008, 0, kU32, true, "name")};
  add_receive_pdo_readings(steps);
  sequence_.start(std::move(steps));
  sequence_.advance(sdo, now_);
}

Identity NodeSetup::read_identity() const {
  const auto number = [&](const char* tag) {
    const auto* outcome = sequence_.find(tag);
    return outcome == nullptr || outcome->error ? 0U : static_cast<std::uint32_t>(outcome->value);
  };
  Identity found{number("vendor"), number("product"), number("revision"), number("serial"), ""};
  if (const auto* name = sequence_.find("name"); name != nullptr)
    found.name = clean_text(std::string(name->bytes.begin(), name->bytes.end()));
  return found;
}

NodeSetup::Step NodeSetup::end_identification(canopen::SdoClient& sdo) {
  if (sequence_.error()) {
    enter(Phase::absent);
    look_after_ = now_ + kAskAgain_s;
    return Step::no_answer;
  }
  const Identity found = read_identity();
  identity_ = found;
  const bool ours = (profile_.vendor == 0 || profile_.vendor == found.vendor) &&
                    (profile_.product == 0 || profile_.product == found.product);
  if (ours) {
    begin_configuration(sdo);
    return Step::identified;
  }
  enter(Phase::foreign);
  event("identity_mismatch",
        "node " + std::to_string(profile_.node) + " is vendor " + std::to_string(found.vendor) +
            ", product " + std::to_string(found.product) + "; profile \"" + profile_.name + "\" expects " +
            std::to_string(profile_.vendor) + ", " + std::to_string(profile_.product) +
            ": nothing is written to it",
        true);
  return Step::identified;
}

void NodeSetup::begin_configuration(canopen::SdoClient& sdo) {
  enter(Phase::configuring);
  unlisted_ = unlisted_pdos(profile_, sequence_.outcomes());
  send_nmt(kNmtPreOperational);
  sequence_.start(configuration(profile_, unlisted_));
  sequence_.advance(sdo, now_);
}

NodeSetup::Step NodeSetup::end_configuration() {
  if (sequence_.error()) {
    event("configuration_failed", sequence_.error()->text(), true);
    enter(Phase::absent);
    look_after_ = now_ + kFailedAgain_s;
    return Step::none;
  }
  note_safety_objects();
  note_as_set_up();
  enter(Phase::starting);
  send_nmt(kNmtStart);
  return Step::configured;
}

void NodeSetup::note_safety_objects() {
  watchdog_armed_ = profile_.watchdog.kind != ProfileWatchdog::Kind::none;
  for (const canopen::SdoOutcome& outcome : sequence_.outcomes()) {
    if (outcome.step.tag == "unlisted" && outcome.error)
      event("process_data_not_disabled", outcome.error->text(), false);
    if (outcome.step.tag != "watchdog" || !outcome.error) continue;
    watchdog_armed_ = false;
    event("watchdog_refused", "the controller cannot watch this program: " + outcome.error->text(), false);
  }
  const auto* quick_stop_option = sequence_.find("605A");
  if (quick_stop_option != nullptr && !quick_stop_option->error && quick_stop_option->value == 0)
    event("coasts_on_quick_stop",
          "605Ah = 0: the drive coasts on a quick stop; the stopping distance is longer", false);
  const auto* mode = sequence_.find("mode");
  if (mode != nullptr && mode->error)
    event("mode_not_active", "mode of operation: " + mode->error->text(), false);
}

/// The last check of each object, and what was found of the reactions that are only read. What the node took
/// otherwise was told when it was set up.
void NodeSetup::note_as_set_up() {
  as_set_up_.clear();
  for (const canopen::SdoOutcome& outcome : sequence_.outcomes()) {
    if (outcome.step.kind == SdoStep::Kind::write || outcome.error) continue;
    SdoStep check = outcome.step;
    check.kind = SdoStep::Kind::check;
    check.value = outcome.value;
    check.optional = false;
    check.tag.clear();
    std::erase_if(as_set_up_, [&](const SdoStep& one) { return one.object == check.object; });
    as_set_up_.push_back(std::move(check));
  }
}

NodeSetup::Step NodeSetup::check_started(const Seen& seen) {
  if (seen.state == kOperationalState && seen.positions && seen.status) {
    enter(Phase::ready);
    return Step::running;
  }
  if (now_ - phase_since_ < kStart_s) return Step::none;
  event("start_failed",
        "the controller is " + canopen::nmt_state_text(seen.state) + " and sends " +
            (seen.positions ? "no status" : "no positions") + " after the NMT start",
        true);
  enter(Phase::absent);
  look_after_ = now_ + kFailedAgain_s;
  return Step::none;
}

}  // namespace odomcalib::drivers
