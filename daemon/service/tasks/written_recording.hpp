// The end of a recording, which the disk may take its time for.
#pragma once

#include <memory>
#include <optional>

#include "daemon/service/telemetry.hpp"

namespace odomcalib {

/// Learns of it also when the recorder says so after the task that waits is gone.
class WrittenRecording {
 public:
  void finish(Recorder& recorder) const {
    recorder.finish([result = result_](const Result<std::filesystem::path>& path) { result->emplace(path); });
  }
  /// Path or error, once the recording is whole.
  [[nodiscard]] const std::optional<Result<std::filesystem::path>>& result() const { return *result_; }

 private:
  using Path = std::optional<Result<std::filesystem::path>>;
  std::shared_ptr<Path> result_ = std::make_shared<Path>();
};

}  // namespace odomcalib
