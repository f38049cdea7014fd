// A configuration of somebody else as YAML and as URDF: whatever it says, the answer is edits that lie within
// the text and after which nothing is left to change, or an error that says what and where.
#include <cstddef>
#include <cstdint>
#include <string>

#include "daemon/cli/diff_drive_place.hpp"
#include "daemon/cli/lidar_joint_place.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using namespace odomcalib;
using fuzz::require;

template <typename Edits>
void check(const std::string& text, const Edits& edits_of) {
  const auto edits = edits_of(text);
  if (!edits) {
    require(!edits.error().what.empty() && edits.error().where.starts_with("fuzz") &&
            !edits.error().remedy.empty());
    return;
  }
  std::size_t done = 0;
  for (const cli::TextEdit& edit : edits.value()) {
    require(edit.at + edit.length <= text.size());
    done += edit.length;
  }
  require(done <= text.size());
  const std::string after = cli::edited(text, edits.value());
  require(cli::diff_of("fuzz", text, after).empty() == (after == text));
  const auto left = edits_of(after);
  require(left.ok() && left.value().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  check(text, [](const std::string& yaml) {
    return cli::diff_drive_edits(yaml,
                                 {{"wheel_separation", 0.41},
                                  {"wheel_radius", 0.0735},
                                  {"wheel_separation_multiplier", 1.0},
                                  {"left_wheel_radius_multiplier", 1.005},
                                  {"right_wheel_radius_multiplier", 0.995}},
                                 "fuzz");
  });
  for (const char* link : {"", "laser"})
    check(text, [&](const std::string& urdf) {
      return cli::lidar_joint_edits(urdf, {0.12, -0.01, 1.5}, link, "fuzz");
    });
  return 0;
}
