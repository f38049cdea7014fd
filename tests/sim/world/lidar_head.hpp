// A spinning range finder of the LD06 kind: one laser on a head that turns clockwise at nearly constant
// speed.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tests/sim/world/body.hpp"
#include "tests/sim/world/geometry.hpp"

namespace odomcalib::sim {

struct LidarOptions {
  double turns_per_second = 9.97;
  int beams_per_turn = 450;
  double range_noise = 0.008;         ///< m, standard deviation
  double range_min = 0.02;            ///< m
  double range_max = 12.0;            ///< m
  double resolution = 0.001;          ///< m, of the reported range; 0 = none
  double grazing_cosine = 0.12;       ///< below this cosine of incidence echoes get lost, more the flatter
  double random_drops = 0.001;        ///< share of beams without echo for no reason
  double first_turn_starts = 0.0137;  ///< s, when beam 0 of turn 0 leaves
};

struct Beam {
  std::int64_t turn = 0;
  int index = 0;           ///< beam within the turn
  double t = 0.0;          ///< s
  double clockwise = 0.0;  ///< rad, direction as the device counts it, [0, 2 pi)
  double range = 0.0;      ///< m, 0 = no echo
  double intensity = 0.0;  ///< 0..255
};

class LidarHead {
 public:
  LidarHead(const Room& room, const Pose& mount, const LidarOptions& options, std::uint64_t seed,
            Disturbances disturbances = {});

  /// Shoots the beams that fall between two instants; the base moves evenly from one pose to the other.
  void advance(double from_time, const Pose& from, double to_time, const Pose& to, std::vector<Beam>& out);
  [[nodiscard]] double beam_interval() const { return beam_interval_; }
  [[nodiscard]] const LidarOptions& options() const { return options_; }

 private:
  [[nodiscard]] Beam shoot(const Pose& base);
  [[nodiscard]] double measured(const Hit& hit);

  const Room& room_;
  Pose mount_;
  LidarOptions options_;
  Disturbances disturbances_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> chance_;
  double beam_interval_;
  std::int64_t next_ = 0;  ///< number of the next beam since the start
};

}  // namespace odomcalib::sim
