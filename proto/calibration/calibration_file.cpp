#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib {

Result<Calibration> read_calibration(const std::filesystem::path& path) {
  auto bytes = read_file_bytes(path);
  if (!bytes) return bytes.error();
  return calibration_from_json(bytes.value(), path.string());
}

Result<void> write_calibration(const Calibration& calibration, const std::filesystem::path& path) {
  return replace_file(path, to_json(calibration));
}

}  // namespace odomcalib
