// A calibration as configuration of what drives a robot.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/text_edit.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Whether robots are driven by it: then a refused calibration is not exported.
bool is_configuration(const std::string& what);

/// Names that `configuration` takes.
const std::vector<std::string>& configurations();

/// Parts of this calibration that odometry, or a comparison of it with the lidar, would need and the format
/// has no room for: a sentence each. The text of the format has them as comments. Of noise: what it assumes
/// that odometry is corrected for.
std::vector<std::string> not_held(const Calibration& calibration, const std::string& what);

/// Error of odometry without its effects (degrees a turn, mm a metre, where the recording shows them), and
/// the means to apply them: a sentence. Empty where it has none.
/// @param is_step of odometry as source, which has most of them
std::string lost_without_effects(const Calibration& calibration, bool is_step);

/// Begins with where the values are from, as a comment.
/// Errors: usage (unknown name), format (the file does not hold it), refused.
/// @param where the calibration is from, for errors
Result<std::string> configuration(const Calibration& calibration, const std::string& what,
                                  const std::string& where);

/// A file of the user's own that has a configuration among other things.
struct OwnText {
  std::string path, text;
  std::string link = {};  ///< of the lidar, for urdf; empty: by its name
};

/// Whether `edits_of` takes this name: diff_drive, urdf.
bool goes_into_files(const std::string& what);

/// Changes to that text after which it has the values of the calibration.
/// Errors: format (the calibration has no such values, the text not one place for them), refused.
/// @param where the calibration is from, for errors
Result<std::vector<TextEdit>> edits_of(const Calibration& calibration, const std::string& what,
                                       const OwnText& own, const std::string& where);

}  // namespace odomcalib::cli
