// One lidar: recordings that are solved together share its mounting.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "calib/ingest/recordings.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Whether scans are the reference: poses and increments replace them.
bool is_by_scans(const Recording& recording);

/// A recording whose scans are of other sensors than the one that was asked for; nullopt where each has some
/// of it, names no sensor, or has another reference than scans. Error: usage.
/// @param sensor empty: none was asked for
std::optional<Error> lacks_sensor(std::span<const Recording> recordings, const std::string& sensor);

/// Recordings of one lidar each (see put_right()) that are of two; nullopt where those that name it name the
/// same. Error: refused; says what besides the name differs.
std::optional<Error> two_sensors(std::span<const Recording> recordings);

/// Recordings of one lidar each whose scans are of one lidar by another name: they get the name of the first
/// that has one, and say so in `repairs`. Those that differ in more than the name (number and directions of
/// the beams, limits of the range, stated mounting) keep theirs. Without any such name the recordings given.
Recordings of_one_name(const Recordings& given);

}  // namespace odomcalib::calib::ingest
