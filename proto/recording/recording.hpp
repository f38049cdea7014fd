// A recording is the only input of calibration (formats: docs/user/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Something in the file that was not used, and why.
struct Discarded {
  std::string what;    ///< e.g. "scan", "line", "event"
  std::string reason;  ///< e.g. "cut off", "out of order by more than 1 s", "unknown fingerprint 0x..."
  std::size_t count = 0;
};

/// Reason of beams that are no distance this lidar can measure.
inline constexpr const char* kOutsideLimits = "outside range_min and range_max";

/// Reason of samples that carry the stamp of the one before.
inline constexpr const char* kRepeatedStamp = "repeated time stamp";

struct Recording {
  std::string name;  ///< file name without folder
  std::string
      sha256;  ///< of the file's bytes as stored (compressed files: of the compressed bytes), lower-case hex
  RobotDescription robot;
  // Each stream is sorted by time when reading is done.
  std::vector<TickSample> ticks;
  std::vector<Scan> scans;
  std::vector<PoseSample> poses;
  std::vector<GyroSample> gyro;
  std::vector<IncrementSample> increments;  ///< tuple files only
  std::vector<Discarded> discarded;
};

/// Reads a recording and recognises its form by content: JSON Lines (plain or gzip), native LCM log, LCM log
/// of the MBot/MaeBot family, Censi's tuple file or raw JSON log, CARMEN log. Errors: io (cannot open), empty
/// (no usable line), missing_units (no or incomplete robot line), format (unknown form). A cut-off end is not
/// an error: what is whole is used, `discarded` says what was not.
/// @param fallback robot description for forms that carry none; its zero fields count as missing
Result<Recording> read_recording(const std::filesystem::path& path,
                                 const RobotDescription* fallback = nullptr);

/// The same for content that is in memory already.
/// @param name file name, for messages and Recording::name
Result<Recording> read_recording_bytes(const std::string& bytes, const std::filesystem::path& name,
                                       const RobotDescription* fallback = nullptr);

/// Writes JSON Lines (gzip when the name ends in .gz). Counterpart of read_recording: numbers survive
/// unchanged.
Result<void> write_recording_jsonl(const Recording& recording, const std::filesystem::path& path);

}  // namespace odomcalib
