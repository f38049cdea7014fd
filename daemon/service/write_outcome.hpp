// Handling of the end of a write-back by the service: committed, rolled back or unknown.
#pragma once

#include "daemon/service/parts/robot_parts.hpp"

namespace odomcalib {

/// Takes over what the controller holds now, and forbids motion where a write-back ended unknown
/// (WriteBack::operator_needed). What belongs on the disk goes there beside the loop: the history, and the
/// calibration that comes into force with a commit. WriteBack::ended says when that is done.
void settle_write(RobotParts& parts, const WriteReport& report);

/// Takes over what was read of the controller, and says where somebody else has changed it.
/// @param written quantities that were written by us since the last time
void settle_reading(Drive& drive, Outbox& outbox, const std::vector<drivers::StoredParameter>& found,
                    const ParameterMap& written = {});

/// At the start, at once: the journal is what counts. Entries that the history lacks are made of it, and the
/// calibration that came with the last commit comes into force.
void settle_from_journal(RobotParts& parts);

/// Looks again, beside the loop and now and then, at a history that could not be listed; nothing is written
/// to the controller before it is. What the journal alone knew goes to the disk then.
void look_again_at_history(RobotParts& parts);

}  // namespace odomcalib
