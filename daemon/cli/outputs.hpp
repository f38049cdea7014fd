// Files that a verb writes: looked at before it does any work, so that no result is lost and no input
// replaced.
#pragma once

#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::cli {

struct NamedFile {
  std::string name;  ///< of the option or argument, for people
  std::string path;  ///< empty: not asked for
};

/// Error: usage, when an output is an input or another output, whatever links and relative paths they are
/// named by; io, when it could not be written.
Result<void> check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Files of one argument that may be repeated.
std::vector<NamedFile> named(const std::string& name, const std::vector<std::string>& paths);

}  // namespace odomcalib::cli
