#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"
#include "proto/visible_text.hpp"

namespace odomcalib {

Result<Calibration> read_calibration(const std::filesystem::path& path) {
  auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  auto calibration = calibration_from_json(bytes.value(), path.string());
  if (!calibration && is_recording(bytes.value()))
    return Error{ErrorCode::format, "is a recording, not a calibration", path.string(),
                 "solve it first: odomcalibctl solve " + shell_word(path.string()) + " --out cal.json"};
  return calibration;
}

Result<void> write_calibration(const Calibration& calibration, const std::filesystem::path& path) {
  return replace_file(path, to_json(calibration));
}

}  // namespace odomcalib
