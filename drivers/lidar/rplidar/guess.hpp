// Guess of the measurement packets' type in a recording that began after the descriptor and so lacks it.
#pragma once

#include <optional>

#include "drivers/lidar/rplidar/packet.hpp"

namespace odomcalib::drivers::rplidar {

struct Guess {
  enum class Kind {
    none,      ///< no packet begins here
    wait,      ///< more bytes are needed to tell; of type express: sound capsules, their layout is open
    found,     ///< packets of `type` begin here
    ambiguous  ///< sound capsules begin here whose layout does not show
  };
  Kind kind = Kind::none;
  PacketType type = PacketType::standard;
};

/// Capsules are believed when two in a row are sound. Express and dense ones look alike but for the layout of
/// their distances: in the right one neighbouring beams mostly see the same wall, in the wrong one hardly
/// ever.
/// @param given layout of capsules of 84 bytes, when the user says it
Guess guess_type(Bytes rest, std::optional<PacketType> given);

}  // namespace odomcalib::drivers::rplidar
