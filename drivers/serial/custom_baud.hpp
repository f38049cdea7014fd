// Baud rates that are not in the POSIX table. A file of its own: <asm/termbits.h> and <termios.h> exclude
// each other.
#pragma once

namespace odomcalib::drivers {

/// Sets any rate through termios2 (BOTHER). False when the driver refuses; errno says why.
bool set_custom_baud(int fd, unsigned baud);

}  // namespace odomcalib::drivers
