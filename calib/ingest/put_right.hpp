// Quirks of scans from common drivers, and what can be undone without a measurement: two lidars on one topic,
// a turn in several messages, the same scan sent again, a head whose speed wanders.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "calib/ingest/recordings.hpp"

namespace odomcalib::calib::ingest {

/// Recordings of one lidar in whole turns, each scan once, in the order of the table in put_right.cpp;
/// without any such fault the recordings given. Each says in its `repairs` and `discarded` what was done.
/// @param sensor whose scans are used; empty: those of the sensor that sent most
Recordings put_right(std::span<const Recording> given, const std::string& sensor = "");

/// Sentence on poses that replace the scans although they cover clearly less of the drive; nullopt: they do
/// not.
std::optional<std::string> word_on_unused_scans(const Recording& recording);

}  // namespace odomcalib::calib::ingest
