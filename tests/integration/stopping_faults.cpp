#include "tests/integration/stopping_faults.hpp"

#include <gtest/gtest.h>

namespace odomcalib {
namespace {

using sim::make_frame;
using sim::SimRobot;

// A fault of content shows with the first whole turn that has it: 0.1 s later than one that breaks the flow.
constexpr double kTurn = 0.100;
// Detection plus 100 ms until the zero command has reached the drive.
constexpr double kEncoder = 0.100 + 0.100, kLidar = 0.250 + 0.100;
constexpr double kOwnWatchdog = 0.200 + 0.100;  // no command passes: the drive's watch of our heartbeat

void nothing(SimRobot& /*robot*/) {}

const Fault kStopping[] = {
    {"F1_cable_out", [](SimRobot& r) { r.cut_can(true); }, [](SimRobot& r) { r.cut_can(false); },
     "heartbeat_lost", kOwnWatchdog},
    {"F1_adapter_out", [](SimRobot& r) { r.unplug_can(); },
     [](SimRobot& r) { ASSERT_TRUE(r.plug_can().ok()); }, "", kOwnWatchdog},
    {"F2_bus_off", [](SimRobot& r) { r.inject_can_bytes("sb255000\r"); }, nothing, "bus_off", 0.1},
    {"F3_error_passive_storm",
     [](SimRobot& r) {
       for (int i = 0; i < 300; ++i) r.inject_can_bytes("sp130010\r");
     },
     nothing, "error_passive", 0.1},
    {"F5_twin_with_other_counts",
     [](SimRobot& r) {
       r.inject(make_frame(0x181, {0x39, 0x30, 0x10, 0, 0x39, 0x30, 0x10, 0}));
     },
     nothing, "tick_jump", 0.1},
    {"F5_twin_that_is_not_started", [](SimRobot& r) { r.inject(make_frame(0x701, {0x7F})); }, nothing,
     "left_operational", 0.1},
    {"F6_controller_reset", [](SimRobot& r) { r.reset_drive(); }, nothing, "", kEncoder},
    {"F7_heartbeat_lost", [](SimRobot& r) { r.node().faults.heartbeat_stopped = true; },
     [](SimRobot& r) { r.node().faults.heartbeat_stopped = false; }, "heartbeat_lost", kEncoder},
    {"F8_emergency", [](SimRobot& r) { r.emergency(0x2310); }, nothing, "emcy", 0.1, 5.0, "fault"},
    {"F12_no_process_data", [](SimRobot& r) { r.node().faults.pdo_silent = true; },
     [](SimRobot& r) { r.node().faults.pdo_silent = false; }, "pdo_frozen", kEncoder},
    {"F12_frozen_process_data", [](SimRobot& r) { r.node().faults.pdo_frozen = true; },
     [](SimRobot& r) { r.node().faults.pdo_frozen = false; }, "encoder_stuck", kEncoder},
    {"F13_process_data_late_by_200_ms", [](SimRobot& r) { r.node().faults.pdo_delay = 0.2; },
     [](SimRobot& r) { r.node().faults.pdo_delay = 0.0; }, "pdo_frozen", kEncoder},
    {"F17_counts_jump", [](SimRobot& r) { r.shift_counts(1'000'000, 0); }, nothing, "tick_jump", kEncoder},
    {"F18_left_encoder_stuck", [](SimRobot& r) { r.hold_encoder(sim::kLeft, true); },
     [](SimRobot& r) { r.hold_encoder(sim::kLeft, false); }, "left count stands still", kEncoder},
    {"F18_right_encoder_stuck", [](SimRobot& r) { r.hold_encoder(sim::kRight, true); },
     [](SimRobot& r) { r.hold_encoder(sim::kRight, false); }, "right count stands still", kEncoder},
    {"F22_lidar_out", [](SimRobot& r) { r.unplug_lidar(); },
     [](SimRobot& r) { ASSERT_TRUE(r.plug_lidar().ok()); }, "no scan", kLidar, 2.0},
    {"F23_half_frames", [](SimRobot& r) { r.lidar_faults().half_packets = true; },
     [](SimRobot& r) { r.lidar_faults().half_packets = false; }, "no scan", kLidar + kTurn},
    {"F24_same_scan_again_and_again", [](SimRobot& r) { r.lidar_faults().frozen = true; },
     [](SimRobot& r) { r.lidar_faults().frozen = false; }, "repeats the same scan", kLidar + kTurn},
    {"F25_empty_scans", [](SimRobot& r) { r.lidar_faults().blind = true; },
     [](SimRobot& r) { r.lidar_faults().blind = false; }, "sees nothing", kLidar + kTurn},
    {"F26_30_percent_of_the_packets_lost", [](SimRobot& r) { r.lidar_faults().share_lost = 0.3; },
     [](SimRobot& r) { r.lidar_faults().share_lost = 0.0; }, "no scan", kLidar + kTurn},
    {"F27_scans_late_by_half_a_second", [](SimRobot& r) { r.lidar_faults().extra_delay = 0.5; },
     [](SimRobot& r) { r.lidar_faults().extra_delay = 0.0; }, "no scan", kLidar},
    {"F29_somebody_steps_into_the_way",
     [](SimRobot& r) {
       r.room().add_pillar({r.pose().x + 0.55, r.pose().y}, 0.08);
     },
     [](SimRobot& r) { r.room() = sim::furnished_room(); }, "in the way", kLidar},
};

}  // namespace

std::span<const Fault> stopping_faults() { return kStopping; }

}  // namespace odomcalib
