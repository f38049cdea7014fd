#include "daemon/writeback/outcome.hpp"

#include <array>

namespace odomcalib {
namespace {

using enum WriteOutcome;

// In the order of the enumeration: outcome, name, of a write, as asked, certain, lasts, proof.
constexpr std::array kEndings = {
    Ending{read, "read", false, false, true, false, nullptr},
    Ending{proving, "proving", true, true, true, false, &DriveProof::other_values},
    Ending{committed, "committed", true, true, true, true, &DriveProof::committed},
    Ending{rolled_back, "rolled_back", true, false, true, true, &DriveProof::taken_back},
    Ending{unknown, "unknown", true, false, false, true, &DriveProof::forget},
};

}  // namespace

std::span<const Ending> endings() { return kEndings; }

const Ending& ending_of(WriteOutcome outcome) { return kEndings.at(static_cast<std::size_t>(outcome)); }

std::string name_of(WriteOutcome outcome) { return ending_of(outcome).name; }

}  // namespace odomcalib
