// Processor time, which other programs on the machine do not lengthen.
#pragma once

#include <ctime>

namespace odomcalib::bench {

/// ms of this process since it began, all threads.
inline double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace odomcalib::bench
