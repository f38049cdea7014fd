// Counts and scans in LCM logs of other robots: MBot and MaeBot family, bot_core lidars. Internal to proto/.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/recording/recording_builder.hpp"
#include "proto/wire/byte_reader.hpp"
#include "proto/wire/event_log.hpp"

namespace odomcalib {

class ForeignMessages {
 public:
  /// @param clockwise sense of lidar_t's angles
  ForeignMessages(RecordingBuilder& builder, bool clockwise) : builder_(builder), clockwise_(clockwise) {}

  /// Robots with these encoder messages are of the older stack, whose lidar_t has clockwise angles.
  static bool is_old_encoder(std::uint64_t fingerprint);
  /// False when the fingerprint is none of those read here.
  bool add(std::uint64_t fingerprint, const LogEvent& event);

 private:
  double time(std::int64_t utime);
  Scan lidar(ByteReader& reader);
  void set_times(Scan& scan, std::int64_t utime, const std::vector<std::int64_t>& stamps);
  [[nodiscard]] float direction(float angle) const;
  Scan planar_lidar(ByteReader& reader);
  TickSample sample(const ByteReader& reader, std::int64_t utime, std::int64_t left, std::int64_t right);
  TickSample mbot_encoders(ByteReader& reader);
  TickSample old_mbot_encoder(ByteReader& reader);
  TickSample maebot_encoders(ByteReader& reader);
  bool finish(const ByteReader& reader, const char* what, Scan scan);
  bool finish(const ByteReader& reader, const char* what, const TickSample& sample);
  bool damaged(const char* what);

  RecordingBuilder& builder_;
  bool clockwise_;
  std::optional<std::int64_t> start_;  // us, whole second of the first message used
};

}  // namespace odomcalib
