#include "drivers/base/canopen/sdo_client.hpp"

#include <algorithm>
#include <utility>

#include "drivers/base/canopen/words.hpp"
#include "drivers/bytes.hpp"

namespace odomcalib::drivers::canopen {
namespace {

constexpr std::uint32_t kAbortTimeout = 0x05040000;
constexpr std::uint32_t kAbortMemory = 0x05040005;
constexpr std::uint32_t kAbortLength = 0x06070010;
constexpr std::size_t kSegment = 7;
constexpr std::uint8_t kAbort = 0x80;

std::uint32_t u32_at(const CanFrame& frame, std::size_t offset) {
  ByteReader reader(Bytes(frame.data).subspan(offset));
  return reader.u32();
}

void put_u32(std::array<std::uint8_t, 8>& payload, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) payload[4 + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace

bool SdoClient::start(SdoRequest request, double now) {
  if (busy_ || result_) return false;
  if (request.write && (request.data.empty() || request.data.size() > kSdoMostBytes)) return false;
  request_ = std::move(request);
  tries_left_ = request_.retries;
  busy_ = true;
  ++transfers_;
  begin(now);
  return true;
}

void SdoClient::cancel() {
  busy_ = false;
  result_.reset();
  out_.clear();
}

void SdoClient::send(const Payload& payload, double now) {
  CanFrame frame;
  frame.id = 0x600u + node_;
  frame.length = 8;
  frame.data = payload;
  out_.push_back(frame);
  deadline_ = now + request_.timeout_s;
}

void SdoClient::begin(double now) {
  segmented_ = false;
  toggle_ = false;
  received_.clear();
  announced_.reset();
  sent_bytes_ = 0;
  Payload payload{};
  payload[0] = 0x40;
  payload[1] = static_cast<std::uint8_t>(request_.object.index);
  payload[2] = static_cast<std::uint8_t>(request_.object.index >> 8);
  payload[3] = request_.object.sub;
  if (request_.write) begin_write(payload);
  send(payload, now);
}

void SdoClient::begin_write(Payload& payload) const {
  const std::size_t n = request_.data.size();
  if (n > 4) {
    payload[0] = 0x21;
    put_u32(payload, static_cast<std::uint32_t>(n));
    return;
  }
  payload[0] = static_cast<std::uint8_t>(0x23 | ((4 - n) << 2));
  std::copy(request_.data.begin(), request_.data.end(), payload.begin() + 4);
}

void SdoClient::send_next_segment(double now) {
  Payload payload{};
  if (request_.write) {
    segment_bytes_ = std::min(kSegment, request_.data.size() - sent_bytes_);
    const bool last = sent_bytes_ + segment_bytes_ == request_.data.size();
    payload[0] = static_cast<std::uint8_t>((toggle_ ? 0x10u : 0u) | ((kSegment - segment_bytes_) << 1) |
                                           (last ? 1u : 0u));
    std::copy_n(request_.data.begin() + static_cast<std::ptrdiff_t>(sent_bytes_), segment_bytes_,
                payload.begin() + 1);
  } else {
    payload[0] = static_cast<std::uint8_t>(0x60u | (toggle_ ? 0x10u : 0u));
  }
  send(payload, now);
}

bool SdoClient::addressed_to_request(const CanFrame& frame) const {
  const unsigned index = frame.data[1] | static_cast<unsigned>(frame.data[2]) << 8;
  return index == request_.object.index && frame.data[3] == request_.object.sub;
}

/// A bus, and what lies between it and us, may deliver a frame twice, late, and after a newer one. What
/// answers another kind of request, or has the toggle bit of the segment before, belongs to what is over.
bool SdoClient::answers_request(std::uint8_t command) const {
  const unsigned specifier = command & 0xE0u;
  if (!segmented_) return specifier == (request_.write ? 0x60u : 0x40u);
  const bool toggle = (command & 0x10u) != 0;
  return specifier == (request_.write ? 0x20u : 0x00u) && toggle == toggle_;
}

bool SdoClient::on_frame(const CanFrame& frame, double now) {
  if (frame.extended || frame.remote || frame.error || frame.id != 0x580u + node_) return false;
  if (frame.length != 8) return ++bad_, true;
  const bool block_transfer = (frame.data[0] & 0xE0) == 0xA0 || (frame.data[0] & 0xE0) == 0xC0;
  const bool has_address = !segmented_ || frame.data[0] == kAbort;
  if (!busy_ || block_transfer || (has_address && !addressed_to_request(frame))) return ++unexpected_, true;
  if (frame.data[0] != kAbort && !answers_request(frame.data[0])) return ++unexpected_, true;
  if (frame.data[0] == kAbort) {
    on_abort(u32_at(frame, 4));
  } else if (request_.write) {
    on_write_answer(now);
  } else if (segmented_) {
    on_read_segment(frame, now);
  } else {
    on_read_start(frame, now);
  }
  return true;
}

void SdoClient::on_read_start(const CanFrame& frame, double now) {
  const std::uint8_t command = frame.data[0];
  const bool expedited = (command & 2) != 0;
  const bool sized = (command & 1) != 0;
  if (expedited) {
    const std::size_t n = sized ? 4u - ((command >> 2) & 3u) : 4u;
    received_.assign(frame.data.begin() + 4, frame.data.begin() + 4 + static_cast<std::ptrdiff_t>(n));
    return finish();
  }
  if (sized) announced_ = u32_at(frame, 4);
  if (announced_ && *announced_ > kSdoMostBytes)
    return refuse(kAbortMemory, "more than 1024 bytes announced", now);
  segmented_ = true;
  send_next_segment(now);
}

void SdoClient::on_read_segment(const CanFrame& frame, double now) {
  const std::uint8_t command = frame.data[0];
  const std::size_t n = kSegment - ((command >> 1) & 7u);
  if (received_.size() + n > announced_.value_or(kSdoMostBytes))
    return refuse(kAbortLength, "more bytes than announced", now);
  received_.insert(received_.end(), frame.data.begin() + 1,
                   frame.data.begin() + 1 + static_cast<std::ptrdiff_t>(n));
  toggle_ = !toggle_;
  if ((command & 1) == 0) return send_next_segment(now);
  if (announced_ && received_.size() != *announced_)
    return refuse(kAbortLength, "fewer bytes than announced", now);
  finish();
}

void SdoClient::on_write_answer(double now) {
  if (!segmented_) {
    if (request_.data.size() <= 4) return finish();
    segmented_ = true;
    return send_next_segment(now);
  }
  sent_bytes_ += segment_bytes_;
  toggle_ = !toggle_;
  if (sent_bytes_ == request_.data.size()) return finish();
  send_next_segment(now);
}

void SdoClient::finish() {
  busy_ = false;
  result_ = SdoResult{request_.object, request_.write, std::move(received_), std::nullopt, std::nullopt};
  received_.clear();
}

void SdoClient::fail(ErrorCode code, const std::string& what, const std::string& remedy) {
  busy_ = false;
  const std::string where = "node " + std::to_string(node_) + ", object " + to_text(request_.object);
  result_ = SdoResult{request_.object, request_.write, {}, std::nullopt, Error{code, what, where, remedy}};
}

void SdoClient::on_abort(std::uint32_t code) {
  ++aborts_;
  fail(ErrorCode::device, std::string(request_.write ? "write" : "read") + " refused: " + abort_text(code));
  result_->abort = code;
}

/// The node's answer breaks the protocol: says so to the node and gives up.
void SdoClient::refuse(std::uint32_t code, const std::string& what, double now) {
  ++bad_;
  Payload payload{kAbort, static_cast<std::uint8_t>(request_.object.index),
                  static_cast<std::uint8_t>(request_.object.index >> 8), request_.object.sub};
  put_u32(payload, code);
  send(payload, now);
  fail(ErrorCode::device, what, "is another SDO client on the bus?");
}

void SdoClient::on_time(double now) {
  if (!busy_ || now < deadline_) return;
  ++timeouts_;
  Payload payload{kAbort, static_cast<std::uint8_t>(request_.object.index),
                  static_cast<std::uint8_t>(request_.object.index >> 8), request_.object.sub};
  put_u32(payload, kAbortTimeout);
  send(payload, now);
  if (tries_left_-- > 0) return begin(now);
  fail(ErrorCode::timeout, "no answer", "is the controller on, and are node id and bit rate right?");
}

std::vector<CanFrame> SdoClient::take_frames() { return std::exchange(out_, {}); }

std::optional<SdoResult> SdoClient::take_result() { return std::exchange(result_, std::nullopt); }

Counters SdoClient::counters() const {
  return {{"sdo_transfers", transfers_},
          {"sdo_aborts", aborts_},
          {"sdo_timeouts", timeouts_},
          {"sdo_unexpected", unexpected_},
          {"sdo_bad", bad_}};
}

}  // namespace odomcalib::drivers::canopen
