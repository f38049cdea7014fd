// Choice between several publishers of one topic. Internal to proto/.
#pragma once

#include <optional>
#include <string>

#include "proto/recording/recording_builder.hpp"
#include "proto/recording/ros/choice.hpp"

namespace odomcalib::ros {

/// Leaves one publisher in each chosen topic but for scans, and tells what went.
/// - Joints: lists of names that hold both wheels and never change beside one that does are left out. Several
/// that
///   change are one where they tell the same motion.
/// - Odometry, poses and gyro: of several frames the one with the most messages.
/// Error: usage, where two lists of names tell different motions.
std::optional<Error> settle_publishers(RecordingBuilder& builder, const Chosen& chosen, bool speeds,
                                       const std::string& where);

/// "front_laser (457 scans), rear_laser (440 scans)" where a topic has scans of several frames; else empty.
std::string frames_of_scans(const Topic& topic);

/// frame_id and child_frame_id, for people.
std::string text_of(const Frames& frames);

}  // namespace odomcalib::ros
