// Readers of the tables that only one family of protocols has. Only for drivers/base/profile/*.cpp.
#pragma once

#include "drivers/base/profile/profile.hpp"
#include "drivers/base/profile/profile_reader.hpp"

namespace odomcalib::drivers {

void read_canopen_tables(ProfileTable& table, Profile& profile);

}  // namespace odomcalib::drivers
