#include "drivers/base/cia402/parameter_job.hpp"

#include <algorithm>
#include <utility>

namespace odomcalib::drivers {
namespace {

using canopen::SdoStep;

StoredParameter stored(const ProfileParameter& parameter, std::int64_t raw) {
  return {parameter.quantity, raw, parameter.to_si(raw), parameter.step()};
}

std::string list_quantities(const Profile& profile) {
  std::string out;
  for (const ProfileParameter& parameter : profile.parameters)
    out += (out.empty() ? "" : ", ") + parameter.quantity;
  return out.empty() ? "none" : out;
}

}  // namespace

Error ParameterJob::failed(ErrorCode code, const std::string& what, const std::string& remedy) const {
  return {code, what, "controller " + profile_.name, remedy};
}

void ParameterJob::begin(ParameterJobResult::Kind kind) {
  kind_ = kind;
  running_ = true;
  reset_wanted_ = false;
  read_back_.clear();
  first_error_.reset();
  result_.reset();
}

Result<void> ParameterJob::start_read(std::vector<SdoStep> as_set_up) {
  wanted_.clear();
  for (const ProfileParameter& parameter : profile_.parameters) wanted_.push_back({&parameter, 0, 0});
  begin(ParameterJobResult::Kind::read);
  start_reading(Stage::before, std::move(as_set_up));
  return {};
}

Result<void> ParameterJob::start_write(const std::vector<ParameterValue>& values) {
  std::vector<Wanted> wanted;
  for (const ParameterValue& value : values) {
    const auto parameter =
        std::find_if(profile_.parameters.begin(), profile_.parameters.end(),
                     [&](const ProfileParameter& p) { return p.quantity == value.quantity; });
    if (parameter == profile_.parameters.end())
      return failed(ErrorCode::refused, "does not store \"" + value.quantity + "\"",
                    "it stores: " + list_quantities(profile_) + "; keep the rest on the host");
    const auto raw = parameter->to_raw(value.value);
    if (!raw)
      return failed(ErrorCode::refused,
                    value.quantity + " = " + std::to_string(value.value) + " m is out of range",
                    "allowed: " + std::to_string(parameter->to_si(parameter->min)) + " to " +
                        std::to_string(parameter->to_si(parameter->max)) + " m");
    wanted.push_back({&*parameter, *raw, 0});
  }
  if (wanted.empty()) return failed(ErrorCode::refused, "nothing to write", "");
  wanted_ = std::move(wanted);
  begin(ParameterJobResult::Kind::write);
  start_reading(Stage::before);
  return {};
}

Result<void> ParameterJob::start_store() {
  if (!profile_.store)
    return failed(ErrorCode::refused, "the profile names no store command",
                  "the values stay in RAM until power-off");
  wanted_.clear();
  for (const ProfileParameter& parameter : profile_.parameters) wanted_.push_back({&parameter, 0, 0});
  begin(ParameterJobResult::Kind::store);
  start_reading(Stage::before);
  return {};
}

std::size_t ParameterJob::index_of(const ProfileParameter& parameter) const {
  return static_cast<std::size_t>(&parameter - profile_.parameters.data());
}

SdoStep ParameterJob::reading_of(const ProfileParameter& parameter) const {
  const std::optional<std::int64_t> known = known_[index_of(parameter)];
  const auto kind = known ? SdoStep::Kind::check : SdoStep::Kind::read;
  return {kind,  parameter.object,       parameter.type,     known.value_or(0),
          false, canopen::kSdoTimeout_s, parameter.quantity, true};
}

/// Values that nobody knows are not read before all is settled: a late answer would tell of another time.
void ParameterJob::start_reading(Stage stage, std::vector<SdoStep> steps) {
  stage_ = stage;
  const bool all_known = std::all_of(wanted_.begin(), wanted_.end(),
                                     [&](const Wanted& one) { return known_[index_of(*one.parameter)]; });
  begins_at_ = all_known ? now_ : settled_at_;
  for (const Wanted& wanted : wanted_) steps.push_back(reading_of(*wanted.parameter));
  sequence_.start(std::move(steps));
}

void ParameterJob::start_writing(Stage stage) {
  stage_ = stage;
  begins_at_ = stage == Stage::restore ? now_ + canopen::kSdoSettles_s : settled_at_;
  std::vector<SdoStep> steps;
  for (const Wanted& wanted : wanted_)
    add_checked_write(steps, wanted.parameter->object, wanted.parameter->type,
                      stage == Stage::restore ? wanted.old_raw : wanted.raw, false,
                      wanted.parameter->quantity);
  sequence_.start(std::move(steps));
}

void ParameterJob::start_storing() {
  stage_ = Stage::store;
  begins_at_ = now_;
  sequence_.start({{SdoStep::Kind::write, profile_.store->object, profile_.store->type, profile_.store->value,
                    false, profile_.store->wait_s, "store"}});
}

void ParameterJob::advance(canopen::SdoClient& sdo, double now) {
  now_ = now;
  if (!running_ || now < begins_at_) return;
  const Stage stage = stage_;
  if (stage == Stage::write || stage == Stage::restore || stage == Stage::store)
    settled_at_ = now + canopen::kSdoSettles_s;
  if (!sequence_.advance(sdo, now)) return;
  learn(stage);
  end_stage();
}

/// Takes the values that were read or written, whole or not at all.
void ParameterJob::learn(Stage stage) {
  if (stage == Stage::store) return;
  for (const Wanted& wanted : wanted_) {
    const auto* outcome = sequence_.find(wanted.parameter->quantity);
    const bool known = !sequence_.error() && outcome != nullptr;
    known_[index_of(*wanted.parameter)] = known ? std::optional(outcome->value) : std::nullopt;
  }
}

void ParameterJob::end_stage() {
  switch (stage_) {
    case Stage::before:
      return after_reading_first();
    case Stage::write:
      return after_writing();
    case Stage::restore:
      return after_restoring();
    case Stage::store:
      return after_storing();
    case Stage::after:
      return after_reading_again();
    case Stage::after_reset:
      return after_reading_after_reset();
    case Stage::reset:
      return;
  }
}

std::vector<StoredParameter> ParameterJob::read_values() const {
  std::vector<StoredParameter> out;
  for (const Wanted& wanted : wanted_) {
    const auto* outcome = sequence_.find(wanted.parameter->quantity);
    if (outcome != nullptr && !outcome->error) out.push_back(stored(*wanted.parameter, outcome->value));
  }
  return out;
}

/// Notes a change from the steps that read the node's other settings. One without an answer shows nothing.
void ParameterJob::note_change() {
  const canopen::SdoOutcome& last = sequence_.outcomes().back();
  if (!last.step.tag.empty() || last.error->code == ErrorCode::timeout) return;
  const std::string found =
      last.abort ? last.error->what
                 : "reads " + std::to_string(last.value) + ", not " + std::to_string(last.step.value);
  change_ = failed(ErrorCode::device,
                   "object " + canopen::to_text(last.step.object) + " " + found +
                       " as it was set up: another program may have changed it",
                   "it is set up again; end the other program, then start again");
}

void ParameterJob::after_reading_first() {
  if (sequence_.error()) {
    note_change();
    return finish(change_ ? change_ : sequence_.error());
  }
  read_back_ = read_values();
  for (std::size_t i = 0; i < wanted_.size(); ++i) wanted_[i].old_raw = read_back_[i].raw;
  switch (kind_) {
    case ParameterJobResult::Kind::read:
      return finish(std::nullopt);
    case ParameterJobResult::Kind::write:
      return start_writing(Stage::write);
    case ParameterJobResult::Kind::store:
      return start_storing();
  }
}

void ParameterJob::after_writing() {
  if (!sequence_.error()) {
    read_back_ = read_values();
    return finish(std::nullopt);
  }
  first_error_ = sequence_.error();
  start_writing(Stage::restore);
}

void ParameterJob::after_restoring() {
  const std::string cause = "write failed (" + first_error_->text() + ")";
  if (sequence_.error())
    return finish(
        failed(ErrorCode::write_unknown,
               cause + " and the old values could not be restored (" + sequence_.error()->text() + ")",
               "read the parameters before the robot moves again"));
  read_back_ = read_values();
  finish(failed(ErrorCode::write_failed, cause, "the old values are in force"));
}

void ParameterJob::after_storing() {
  first_error_ = sequence_.error();
  start_reading(Stage::after);
}

void ParameterJob::after_reading_again() {
  if (sequence_.error())
    return finish(failed(ErrorCode::write_unknown,
                         "no answer after the store (" + sequence_.error()->text() + ")",
                         "power-cycle the controller and read the parameters"));
  read_back_ = read_values();
  if (!reads_what_was_stored())
    return finish(failed(ErrorCode::write_unknown, "values changed while they were stored",
                         "read the parameters before the robot moves again"));
  if (!first_error_ && profile_.store->verify_after_reset) {
    stage_ = Stage::reset;
    reset_wanted_ = true;
    return;
  }
  if (!first_error_) return finish(std::nullopt);
  if (first_error_->code == ErrorCode::timeout)
    return finish(failed(ErrorCode::write_unknown, "no answer to the store command",
                         "power-cycle the controller and read the parameters to see which set it kept"));
  finish(failed(ErrorCode::write_failed, "store refused (" + first_error_->text() + ")",
                "the new values are in RAM only; disable the axes and store again"));
}

bool ParameterJob::reads_what_was_stored() const {
  return std::equal(wanted_.begin(), wanted_.end(), read_back_.begin(), read_back_.end(),
                    [](const Wanted& w, const StoredParameter& s) { return w.old_raw == s.raw; });
}

bool ParameterJob::take_reset_request() { return std::exchange(reset_wanted_, false); }

void ParameterJob::on_set_up_again() {
  if (resetting()) start_reading(Stage::after_reset);
}

void ParameterJob::after_reading_after_reset() {
  if (sequence_.error())
    return finish(
        failed(ErrorCode::write_unknown,
               "no answer after the reset that follows the store (" + sequence_.error()->text() + ")",
               "power-cycle the controller and read the parameters"));
  read_back_ = read_values();
  if (reads_what_was_stored()) return finish(std::nullopt);
  finish(failed(ErrorCode::write_failed,
                "the controller took the store command but came back from a reset with other values",
                "is its memory write-protected, or worn out? the values can be kept on the host"));
}

void ParameterJob::finish(std::optional<Error> error) {
  running_ = false;
  reset_wanted_ = false;
  result_ = ParameterJobResult{kind_, std::move(error), read_back_};
}

void ParameterJob::abandon() {
  if (!running_) return;
  sequence_.cancel();
  const bool touched = stage_ != Stage::before;
  finish(failed(touched ? ErrorCode::write_unknown : ErrorCode::device, "controller was lost during the job",
                touched ? "read the parameters before the robot moves again" : "try again when it is back"));
}

std::optional<ParameterJobResult> ParameterJob::take_result() { return std::exchange(result_, std::nullopt); }

}  // namespace odomcalib::drivers
