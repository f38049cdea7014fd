// A second program that writes one and the same value on a topic again and again, between the values of the
// one that knows: zeros of a joint state publisher without a controller, of a tracker that has lost its
// marker. Internal to proto/.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace odomcalib {

/// One sample of a stream: the two wheels, or x, y and yaw.
using Values = std::array<double, 3>;

/// Indices of the samples with such a value; empty where there is no second writer. A robot that stands
/// repeats a value as well, but the values around it are near.
/// @param samples in time order
std::vector<std::size_t> of_second_writer(std::span<const Values> samples);

}  // namespace odomcalib
