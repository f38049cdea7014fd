// A solve that can be cancelled.
#pragma once

#include <atomic>
#include <memory>

#include "daemon/service/calibrator.hpp"

namespace odomcalib {

/// Set by the service, read by the thread that solves.
using CancelFlag = std::shared_ptr<std::atomic<bool>>;

/// The same functions; `solve` ends with an exception at the first progress report after the flag was set.
Calibrator cancellable(Calibrator calibrator, CancelFlag cancelled);

}  // namespace odomcalib
