// Recordings of one robot as a value: nobody changes them any more, and a copy costs nothing.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Heads of a lidar that recordings do not tell.
enum class SweepKind {
  assumed,            ///< times of beams are not stated: it turns once from scan to scan, as most do
  instead_of_stated,  ///< it turns so, although the scans state other times
  /// Beams are listed against the order in which they were sent, as by a head that turns clockwise under a
  /// driver that sorts them the other way and counts their times along the list.
  against_the_list,
};

/// Report of stamps that were not believed: times that were replaced, the largest of all recordings, s; zero
/// where those given are right.
struct StampReport {
  double ticks = 0.0;  ///< jitter of stamps that were evened out
  double scans = 0.0;
  double sweep = 0.0;                   ///< between beams, of what their scans do not say
  double turn = 0.0;                    ///< s, of the head then, beyond what was stated; negative clockwise
  SweepKind kind = SweepKind::assumed;  ///< of the sweep, where there is a turn
  double sweep_p_value = 1.0;           ///< of scans taken for instants after all
  /// s, standard deviation between the recordings, of clocks that were aligned.
  double clocks = 0.0;
  [[nodiscard]] bool any() const { return ticks > 0.0 || scans > 0.0 || sweep > 0.0 || clocks > 0.0; }
};

/// As the calibration file has it.
StampTimes entry_of(const StampReport& report);

/// A sentence for each that is worth a look at the driver.
std::vector<std::string> remarks_on(const StampReport& report);

/// Scans that are used as instants although their head turns are bent: the effect that bears the name of what
/// was put right, with c the time of a turn over 2 pi.
std::vector<EffectResult> effects_of(const StampReport& report);

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

/// The metre of a reference: lengths follow it, and no motion of the robot shows whether it is one. Of a
/// lidar of which nobody said more: as its data sheet has it. nullopt of other references, whose metre
/// is whoever's measured them.
std::optional<Scale> scale_by_data_sheet(std::span<const Recording> recordings);

/// Lengths of the reference (ranges and their limits, x and y of poses and of motions) multiplied by the
/// scale; of a scale of one the recordings given.
Recordings with_scale(std::span<const Recording> given, double scale);

}  // namespace odomcalib::calib::ingest
