// Recordings of one robot as a value: nobody changes them any more, and a copy costs nothing.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "calib/ingest/stamp_report.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

class Recordings {
 public:
  Recordings() = default;
  /// @param given which the caller keeps alive
  explicit Recordings(std::span<const Recording> given) : view_(given) {}
  /// Others in the place of those given.
  /// @param stamps what they say of times that were replaced
  Recordings(std::vector<Recording> repaired, const StampReport& stamps);

  [[nodiscard]] std::span<const Recording> view() const { return view_; }
  [[nodiscard]] std::size_t size() const { return view_.size(); }
  [[nodiscard]] const Recording& operator[](std::size_t k) const { return view_[k]; }
  [[nodiscard]] const Recording& front() const { return view_.front(); }
  [[nodiscard]] const StampReport& stamps() const { return stamps_; }
  /// Whether these are the very recordings of the other, not changed ones.
  [[nodiscard]] bool are_those_of(const Recordings& other) const;

  /// The same recordings with another report.
  [[nodiscard]] Recordings reported_as(const StampReport& stamps) const;

 private:
  std::shared_ptr<const std::vector<Recording>> owner_;  ///< null: the caller
  std::span<const Recording> view_;
  StampReport stamps_;
};

/// Recordings of which some are changed: all are copied when the first of them is.
class Repairs {
 public:
  /// @param given which the caller keeps alive
  explicit Repairs(std::span<const Recording> given) : given_(given) {}
  /// The copy of one, to be changed.
  Recording& own(std::size_t k);
  [[nodiscard]] bool any() const { return !own_.empty(); }
  /// The copies, or the recordings given where none was changed.
  /// @param stamps that were replaced in the copies
  Recordings take(const StampReport& stamps = {}) &&;

 private:
  std::span<const Recording> given_;
  std::vector<Recording> own_;  ///< empty before the first change
};

/// Ticks that were sampled evenly get even stamps; without any such ticks the recordings given.
Recordings with_even_ticks(std::span<const Recording> given);

}  // namespace odomcalib::calib::ingest
