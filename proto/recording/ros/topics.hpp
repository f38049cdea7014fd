// Choice of the topics, and the way from there into a recording. Internal to proto/.
#pragma once

#include <optional>
#include <string>

#include "proto/recording/recording_builder.hpp"
#include "proto/recording/ros/collector.hpp"

namespace odomcalib::ros {

/// Puts the chosen topics into the builder, and what else there was as discarded; every choice is told.
/// - What the user chose is taken; of the rest, what is unique. Several that could be meant are an error that
/// lists
///   them, but for the gyro, which nothing needs.
/// - Wheel motion is that of the finest kind there is, unless one was chosen: wheels, wheel_speeds, odometry.
/// - Poses replace scan matching and are often goals: they are taken unasked only where there are no scans.
/// - Times are the headers' stamps, unless these come from different clocks: then those of reception. They
/// count
///   from the whole second of the first one.
/// Error: usage, or empty (no wheel motion).
std::optional<Error> fill(RecordingBuilder& builder, Collector& collector, const TopicChoices& choices,
                          const std::string& where);

}  // namespace odomcalib::ros
