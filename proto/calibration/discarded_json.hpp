// Left-out and repaired parts of a recording, as every document of ours has them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "proto/discarded.hpp"

namespace odomcalib {

/// Times are null where there are none.
nlohmann::ordered_json to_json(const Discarded& one);
nlohmann::ordered_json to_json(const Repair& one);
nlohmann::ordered_json to_json(const std::vector<Discarded>& list);
nlohmann::ordered_json to_json(const std::vector<Repair>& list);

}  // namespace odomcalib
