#include "tests/sim/world/rooms.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::sim::rooms_test {
namespace {

TEST(Rooms, every_random_room_is_closed_and_leaves_the_start_free) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Room room = random_room(seed, 1.9);
    EXPECT_GE(room.clearance({0, 0}), 1.3) << "seed " << seed;
    for (int i = 0; i < 90; ++i) {
      const auto hit = room.cast({0, 0}, 0.07 * i);
      ASSERT_TRUE(hit.has_value()) << "seed " << seed << " direction " << i;
      EXPECT_LT(hit->range, 17.0) << "seed " << seed;
    }
    EXPECT_GE(room.wall_count(), 16U) << "seed " << seed;
  }
}

TEST(Rooms, ready_made_rooms_are_closed_about_the_start) {
  for (const Room& room : {furnished_room(), workshop(), round_room()}) {
    EXPECT_GE(room.clearance({0, 0}), 1.9);
    for (int i = 0; i < 628; ++i) EXPECT_TRUE(room.cast({0, 0}, 0.01 * i).has_value());
  }
}

TEST(Rooms, same_seed_same_room) {
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(random_room(3).cast({0, 0}, 0.06 * i)->range, random_room(3).cast({0, 0}, 0.06 * i)->range);
  EXPECT_NE(random_room(3).cast({0, 0}, 0.1)->range, random_room(4).cast({0, 0}, 0.1)->range);
}

}  // namespace
}  // namespace odomcalib::sim::rooms_test
