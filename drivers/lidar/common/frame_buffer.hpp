// The buffer in front of every lidar's parser, and its account: bytes in = good + skipped + buffered, and one
// named counter per kind of rejection.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/bytes.hpp"
#include "drivers/can/transport.hpp"  // Counters

namespace odomcalib::drivers {

/// Verdict of a parser on the bytes at the front.
struct Verdict {
  enum class Kind { wait, skip, good };
  Kind kind = Kind::wait;
  std::size_t bytes = 0;
  const char* rejection = nullptr;  ///< why bytes are skipped; none for mere noise between frames

  /// More bytes are needed to tell.
  static Verdict wait() { return {}; }
  static Verdict noise(std::size_t n = 1) { return {Kind::skip, n, nullptr}; }
  static Verdict reject(const char* why, std::size_t n = 1) { return {Kind::skip, n, why}; }
  static Verdict good(std::size_t n) { return {Kind::good, n, nullptr}; }
};

class FrameBuffer {
 public:
  /// @param rejections every name that reject() and Verdict::reject() will use, so that all are shown from
  /// the start
  FrameBuffer(std::initializer_list<const char*> rejections) {
    for (const char* name : rejections) rejected_.emplace_back(name, 0);
  }

  /// Asks `look(rest)` for a verdict on the front of the buffer until it wants to wait. `rest` reaches to the
  /// end of this read, so that what lies behind a frame can date it.
  template <typename Look>
  void feed(Bytes bytes, Look look) {
    bytes_in_ += bytes.size();
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    const Bytes all(buffer_);
    std::size_t used = 0;
    while (used < all.size()) {
      const Verdict verdict = look(all.subspan(used));
      if (verdict.kind == Verdict::Kind::wait || verdict.bytes > all.size() - used) break;
      account(verdict);
      used += verdict.bytes;
    }
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(used));
  }

  /// Counts a rejection of something that is not a frame, such as a turn that is too short.
  void reject(const char* why, std::uint64_t times = 1) { count_of(why) += times; }

  /// Skips the buffered bytes: they will never be completed.
  void reset() {
    skipped_ += buffer_.size();
    buffer_.clear();
  }

  [[nodiscard]] Counters rejected() const { return {rejected_.begin(), rejected_.end()}; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::size_t buffered() const { return buffer_.size(); }

  /// bytes_in, good, skipped, buffered, packets, and every rejection.
  [[nodiscard]] Counters counters() const {
    Counters all = rejected();
    all["bytes_in"] = bytes_in_;
    all["good"] = good_;
    all["skipped"] = skipped_;
    all["buffered"] = buffer_.size();
    all["packets"] = frames_;
    return all;
  }

 private:
  void account(const Verdict& verdict) {
    const bool good = verdict.kind == Verdict::Kind::good;
    (good ? good_ : skipped_) += verdict.bytes;
    frames_ += good ? 1 : 0;
    if (verdict.rejection != nullptr) reject(verdict.rejection);
  }

  std::uint64_t& count_of(std::string_view why) {
    for (auto& [name, times] : rejected_)
      if (name == why) return times;
    return rejected_.emplace_back(why, 0).second;
  }

  std::vector<std::uint8_t> buffer_;
  std::uint64_t bytes_in_ = 0, good_ = 0, skipped_ = 0, frames_ = 0;
  // A few names that live as long as the program: noise is counted without taking memory.
  std::vector<std::pair<std::string_view, std::uint64_t>> rejected_;
};

}  // namespace odomcalib::drivers
