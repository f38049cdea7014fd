#include "daemon/writeback/calibration_in_force.hpp"

#include <vector>

#include "proto/calibration/report_data.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

constexpr const char* kNone = "none";

}  // namespace

std::string text_in_force(Calibration calibration) {
  calibration.picture.reset();
  // Nobody needs to understand a picture to leave it out.
  if (const auto whole = calibration.unknown.find(""); whole != calibration.unknown.end())
    whole->second.erase(kPictureMember);
  return to_json(calibration);
}

std::filesystem::path CalibrationInForce::file_of(const std::string& id) const {
  return announced_ / (id + ".json");
}

void CalibrationInForce::forget_all_but(const std::string& journaled) const {
  std::vector<std::filesystem::path> others;
  std::error_code error;
  for (std::filesystem::directory_iterator it(announced_, error), end; !error && it != end;
       it.increment(error))
    if (it->path() != file_of(journaled)) others.push_back(it->path());
  for (const auto& other : others) std::filesystem::remove(other, error);
}

Result<std::string> CalibrationInForce::announce(const std::optional<std::string>& calibration,
                                                 const std::string& journaled) const {
  forget_all_but(journaled);
  if (!calibration) return std::string(kNone);
  const std::string id = sha256_hex(*calibration);
  std::error_code error;
  std::filesystem::create_directories(announced_, error);
  if (auto written = replace_file(file_of(id), *calibration); !written) return written.error();
  return id;
}

std::optional<std::string> CalibrationInForce::announced(const std::string& id) const {
  const auto bytes = read_file_bytes(file_of(id));
  if (!bytes || sha256_hex(bytes.value()) != id) return std::nullopt;
  return bytes.value();
}

Result<void> CalibrationInForce::settle(const std::string& id) const {
  if (id.empty()) return {};
  if (id == kNone) return put_out_of_force();
  const auto present = read_file_bytes(path_);
  if (present && sha256_hex(present.value()) == id) return {};
  if (const auto calibration = announced(id)) return replace_file(path_, *calibration);
  return Error{ErrorCode::io, "the calibration that was applied is missing or damaged", file_of(id).string(),
               "apply it again"};
}

Result<void> CalibrationInForce::put_out_of_force() const {
  std::error_code error;
  std::filesystem::remove(path_, error);
  if (!error) return {};
  return Error{ErrorCode::io, "cannot remove: " + error.message(), path_.string(),
               "check the state directory"};
}

}  // namespace odomcalib
