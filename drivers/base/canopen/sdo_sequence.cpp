#include "drivers/base/canopen/sdo_sequence.hpp"

#include <algorithm>
#include <utility>

namespace odomcalib::drivers::canopen {
namespace {

SdoRequest request_of(const SdoStep& step) {
  SdoRequest request;
  request.object = step.object;
  request.write = step.kind == SdoStep::Kind::write;
  request.timeout_s = step.timeout_s;
  request.retries = request.write ? 1 : 2;
  if (request.write && step.timeout_s > kSdoTimeout_s)
    request.retries = 0;  // a store is never repeated blindly
  if (request.write) request.data = encode(step.value, step.type);
  return request;
}

std::optional<Error> difference(const SdoStep& step, const SdoOutcome& outcome) {
  if (step.kind != SdoStep::Kind::check || step.any || outcome.value == step.value) return std::nullopt;
  return Error{
      ErrorCode::device,
      "reads " + std::to_string(outcome.value) + " after " + std::to_string(step.value) + " was written",
      "object " + to_text(step.object), ""};
}

}  // namespace

void add_checked_write(std::vector<SdoStep>& steps, const ObjectAddress& object, NumberType type,
                       std::int64_t value, bool optional, const std::string& tag) {
  steps.push_back({SdoStep::Kind::write, object, type, value, optional, kSdoTimeout_s, tag});
  steps.push_back({SdoStep::Kind::check, object, type, value, optional, kSdoTimeout_s, tag});
}

void SdoSequence::start(std::vector<SdoStep> steps) {
  steps_ = std::move(steps);
  outcomes_.clear();
  error_.reset();
  running_ = true;
  waiting_ = false;
  again_at_.reset();
}

void SdoSequence::cancel() {
  running_ = false;
  waiting_ = false;
}

void SdoSequence::note(const SdoResult& result) {
  SdoOutcome outcome;
  outcome.step = steps_[outcomes_.size()];
  outcome.bytes = result.data;
  outcome.value = decode(result.data, outcome.step.type);
  outcome.abort = result.abort;
  outcome.error = result.error;
  if (!outcome.error) outcome.error = difference(outcome.step, outcome);
  if (outcome.error && !outcome.step.optional) error_ = outcome.error;
  const bool ends_row = outcome.error && outcome.step.one_of_row;
  outcomes_.push_back(std::move(outcome));
  if (ends_row) leave_out_the_row();
}

void SdoSequence::leave_out_the_row() {
  const auto next = steps_.begin() + static_cast<std::ptrdiff_t>(outcomes_.size());
  steps_.erase(next, std::find_if(next, steps_.end(), [](const SdoStep& step) { return !step.one_of_row; }));
}

bool SdoSequence::to_be_confirmed(const SdoResult& result) const {
  const SdoStep& step = steps_[outcomes_.size()];
  if (step.kind != SdoStep::Kind::check || again_at_) return false;
  if (result.error) return result.abort && !step.optional;
  return decode(result.data, step.type) != step.value;
}

bool SdoSequence::advance(SdoClient& client, double now) {
  if (!running_) return false;
  if (waiting_) {
    const auto result = client.take_result();
    if (!result) return false;
    waiting_ = false;
    if (to_be_confirmed(*result)) {
      again_at_ = now + kSdoSettles_s;
    } else {
      again_at_.reset();
      note(*result);
    }
  }
  if (again_at_ && now < *again_at_) return false;
  if (error_ || outcomes_.size() == steps_.size()) {
    running_ = false;
    return true;
  }
  waiting_ = client.start(request_of(steps_[outcomes_.size()]), now);
  return false;
}

const SdoOutcome* SdoSequence::find(const std::string& tag) const {
  const SdoOutcome* found = nullptr;
  for (const SdoOutcome& outcome : outcomes_)
    if (outcome.step.tag == tag) found = &outcome;
  return found;
}

}  // namespace odomcalib::drivers::canopen
