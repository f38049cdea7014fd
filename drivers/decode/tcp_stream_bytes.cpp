#include "drivers/decode/tcp_stream_bytes.hpp"

#include <algorithm>
#include <cstdlib>

#include "drivers/decode/settings.hpp"

namespace odomcalib::drivers {

std::int64_t TcpStreamBytes::position(std::uint32_t sequence) const {
  const auto step = static_cast<std::int32_t>(sequence - static_cast<std::uint32_t>(next_));
  return next_ + step;
}

void TcpStreamBytes::on_start(std::uint32_t sequence) {
  finish();
  after_gap_ = bytes_ > 0;  // what a connection before had left unfinished stays so
  started_ = true;
  next_ = std::int64_t{sequence} + 1;  // the mark of the beginning counts as a byte
}

void TcpStreamBytes::append(Bytes data) {
  if (data.empty()) return;
  if (runs_.empty() || after_gap_) runs_.push_back({{}, std::exchange(after_gap_, false)});
  runs_.back().bytes.insert(runs_.back().bytes.end(), data.begin(), data.end());
  bytes_ += data.size();
  next_ += static_cast<std::int64_t>(data.size());
}

void TcpStreamBytes::on_segment(std::uint32_t sequence, Bytes data) {
  if (data.empty()) return;
  const bool is_other = started_ && std::abs(position(sequence) - next_) > decoding::kFarthest;
  if (!started_ || is_other) on_start(sequence - 1);
  const std::int64_t at = position(sequence);
  if (at > next_) {
    std::vector<std::uint8_t>& place = waiting_[at];
    if (data.size() <= place.size()) {
      repeated_ += data.size();
      return;
    }
    repeated_ += place.size();
    waiting_bytes_ += data.size() - place.size();
    place.assign(data.begin(), data.end());
    if (waiting_bytes_ > decoding::kMostWaiting) skip_to(waiting_.begin()->first);
    return;
  }
  const std::size_t known = static_cast<std::size_t>(std::min<std::int64_t>(next_ - at, std::ssize(data)));
  repeated_ += known;
  append(data.subspan(known));
  give_out_waiting();
}

void TcpStreamBytes::give_out_waiting() {
  while (!waiting_.empty() && waiting_.begin()->first <= next_) {
    const auto first = waiting_.extract(waiting_.begin());
    const std::vector<std::uint8_t>& data = first.mapped();
    waiting_bytes_ -= data.size();
    const std::size_t known =
        static_cast<std::size_t>(std::min<std::int64_t>(next_ - first.key(), std::ssize(data)));
    repeated_ += known;
    append(Bytes(data).subspan(known));
  }
}

void TcpStreamBytes::skip_to(std::int64_t at) {
  lost_ += static_cast<std::uint64_t>(at - next_);
  ++gaps_;
  next_ = at;
  after_gap_ = true;
  give_out_waiting();
}

void TcpStreamBytes::on_acknowledged(std::uint32_t sequence) {
  if (!started_) return;
  const std::int64_t at = position(sequence);
  if (std::abs(at - next_) > decoding::kFarthest) return;
  while (at > next_ && !waiting_.empty() && waiting_.begin()->first < at) skip_to(waiting_.begin()->first);
  // One more than the data is the mark of the end.
  if (at > next_ + 1) skip_to(at);
}

void TcpStreamBytes::finish() {
  while (!waiting_.empty()) skip_to(waiting_.begin()->first);
}

}  // namespace odomcalib::drivers
