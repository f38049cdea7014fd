// The state directory: one daemon at a time writes to it.
#pragma once

#include <filesystem>
#include <optional>

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

}  // namespace odomcalib
