#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <system_error>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/options.hpp"
#include "drivers/decode/decode.hpp"
#include "odomcalib_paths.hpp"
#include "proto/file_bytes.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::cli {
namespace {

/// A program that runs where it was unpacked has its folder beside it.
std::string profile_folder() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return (program.parent_path() / kProfileFolder).lexically_normal();
}

struct DecodeOptions {
  std::string driver, file, profiles = profile_folder();
};

int decode_file(const DecodeOptions& options, const Session& session) {
  const auto bytes = read_file_bytes(options.file);
  if (!bytes) return report_error(bytes.error(), session.json);
  if (is_recording(bytes.value()))
    return report_error({ErrorCode::format, "is a recording, not what a device sent", options.file,
                         "odomcalibctl solve, predict and convert read it"},
                        session.json);
  const auto lines = [&] {
    const Meanwhile shown("decoding " + options.file);
    return drivers::decode(options.driver, bytes.value(), options.profiles, options.file);
  }();
  if (!lines) return report_error(lines.error(), session.json);
  std::cout << lines.value();
  return kDone;
}

}  // namespace

void add_decode(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "decode", "Bytes of a device, or a candump log, as JSON Lines", decode_file);
  verb->add_option("DRIVER", options->driver,
                   "a lidar type (ld06, rplidar, ydlidar:x4, hokuyo, sick, xv11, ...), "
                   "or a controller: PROTOCOL:PROFILE (canopen:zlac8015d, agilex, vesc, ...)")
      ->required();
  verb->add_option("FILE", options->file, "bytes as the device sent them, or what candump -L wrote")
      ->required();
  verb->add_option("--profiles", options->profiles, "folder of the profiles")->capture_default_str();
}

}  // namespace odomcalib::cli
