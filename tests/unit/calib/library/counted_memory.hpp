// How often memory is taken from the heap, by whatever part of the process, libraries among them.
#pragma once

#include <cstddef>

namespace odomcalib::test_support {

/// Begins at zero.
void count_allocations();
/// Since then; ends the counting.
std::size_t counted_allocations();

}  // namespace odomcalib::test_support
