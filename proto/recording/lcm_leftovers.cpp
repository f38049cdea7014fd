#include "proto/recording/lcm_leftovers.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "proto/wire/messages.hpp"

namespace odomcalib {
namespace {

constexpr std::size_t kMostListed = 50;

struct Known {
  std::uint64_t fingerprint;
  const char* name;
};
/// Messages that are known and carry nothing that calibration uses.
constexpr std::array<Known, 14> kUnused{{{messages::kPathFingerprint, "path_t"},
                                         {messages::kEventFingerprint, "event_t"},
                                         {messages::kJsonFingerprint, "json_t"},
                                         {0x2e16efb052b0105e, "bot_core.pose_t"},
                                         {0xea9ffbf2acc5c5ae, "bot_core.rigid_transform_t"},
                                         {0x30571b45b804c18e, "bot_core.raw_t"},
                                         {0x22bd8eb19e834aad, "bot_core.sensor_status_t"},
                                         {0x1f317af1246276ac, "mbot_lcm_msgs.pose2D_t"},
                                         {0x85d72aee83523195, "mbot_lcm_msgs.twist2D_t"},
                                         {0x8119c7c9136961b1, "mbot_lcm_msgs.mbot_motor_vel_t"},
                                         {0x9ef39a5ffc75e462, "mbot_lcm_msgs.mbot_imu_t"},
                                         {0xefadf583af374079, "mbot_lcm_msgs.path2D_t"},
                                         {0x4d0d41c1f105b12f, "mbot_lcm_msgs.timestamp_t"},
                                         {0xed966784146237ec, "maebot_imu_t"}}};

std::string hex(std::uint64_t value) {
  std::array<char, 19> text{};
  (void)std::snprintf(text.data(), text.size(), "0x%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

}  // namespace

void LcmLeftovers::add(std::uint64_t fingerprint) {
  const auto known = std::find_if(kUnused.begin(), kUnused.end(),
                                  [&](const Known& k) { return k.fingerprint == fingerprint; });
  if (known != kUnused.end()) return builder_.discard("event", std::string("not needed: ") + known->name);
  const bool seen = std::find(seen_.begin(), seen_.end(), fingerprint) != seen_.end();
  if (!seen && seen_.size() >= kMostListed) return builder_.discard("event", "unknown fingerprint, others");
  if (!seen) seen_.push_back(fingerprint);
  builder_.discard("event", "unknown fingerprint " + hex(fingerprint));
}

}  // namespace odomcalib
