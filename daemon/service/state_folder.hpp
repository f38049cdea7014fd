// The state directory: one daemon at a time writes to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib {

class StateFolder {
 public:
  /// Makes it where needed and locks it (flock). Where it cannot be written to, it is left alone, see
  /// read_only(). Error: io, another daemon has it.
  static Result<StateFolder> open(const std::filesystem::path& path);
  ~StateFolder();
  StateFolder(StateFolder&& other) noexcept;
  StateFolder& operator=(StateFolder&&) = delete;

  /// Why nothing can be written to it.
  [[nodiscard]] const std::optional<Error>& read_only() const { return read_only_; }

 private:
  StateFolder() = default;
  int lock_ = -1;
  std::optional<Error> read_only_;
};

/// How much of the past is kept on the disk.
struct Retention {
  std::uintmax_t most_bytes = 0;
  std::size_t most = 0;  ///< files; those whose names differ in the extension only count as one
};

/// Removes the oldest files of a folder until the others are no more than that; the newest stays however
/// large it is. What cannot be removed is passed over. @return names without extension of what was removed
std::vector<std::string> keep_newest(const std::filesystem::path& folder, const Retention& retention);

}  // namespace odomcalib
