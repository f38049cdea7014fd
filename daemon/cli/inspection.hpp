// Content of a recording, what solve would take of it, and what its motion is enough for: without measuring
// anything.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/classical/motion_kinds.hpp"
#include "daemon/cli/document.hpp"
#include "daemon/cli/recordings.hpp"
#include "proto/recording/overview.hpp"

namespace odomcalib::cli {

/// Samples of one kind.
struct StreamSummary {
  std::string name;
  std::size_t samples = 0;
  double begin = 0.0, end = 0.0;  ///< s on the recording's clock
  double longest_gap = 0.0;       ///< s

  [[nodiscard]] double rate() const;  ///< 1/s; 0 of one sample
};

struct ScanSummary {
  std::size_t fewest_beams = 0, most_beams = 0;
  double field_of_view = 0.0;                  ///< rad, of the first scan
  double range_min = 0.0, range_max = 0.0;     ///< m, of the first scan
  double share_read = 0.0;                     ///< of all beams, that met something
  bool states_times = false;                   ///< of its beams
  std::map<std::string, std::size_t> sensors;  ///< scans of each, where they name them
};

struct Motion {
  calib::classical::MotionKinds kinds;
  std::vector<calib::classical::ParameterSupply> supply;
};

struct Inspection {
  std::string path;
  std::string solve_arguments;  ///< the recording and the options it was read with, as a shell takes them
  Overview overview;
  std::optional<Error> error;          ///< why solve would end before it measures anything
  std::optional<Recording> recording;  ///< none where nothing could be read
  std::vector<std::string> assumed;  ///< nominal values that nobody stated, and were made up to count motion
  std::vector<StreamSummary> streams;
  std::optional<ScanSummary> scans;
  std::optional<Motion> motion;  ///< none where lengths of it are not known at all
};

/// Errors: io, usage (options that make no sense), and those of a file in which there is nothing to show.
/// Anything else wrong with the recording is in the result.
Result<Inspection> inspect(const std::string& path, const RecordingOptions& options);

Document describe(const Inspection& inspection);
/// Members of the document "inspection".
nlohmann::ordered_json to_json(const Inspection& inspection);

}  // namespace odomcalib::cli
