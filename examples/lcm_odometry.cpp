// Corrected odometry beside odomcalibd: hears the wheel counts that it publishes (odomcalib.ticks_t on TICKS)
// and publishes poses (odomcalib.pose_t on CORRECTED_POSE). The types are made from the installed files:
//
//   lcm-gen --cpp /usr/share/odomcalib/lcm/*.lcm
//   c++ -std=c++17 -I. lcm_odometry.cpp $(pkg-config --cflags --libs lcm odomcalib) -o lcm_odometry
//   ./lcm_odometry cal.json
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <odomcalib/odometry.hpp>
#include <string>

#include "odomcalib/pose_t.hpp"
#include "odomcalib/ticks_t.hpp"

class Node {
 public:
  Node(lcm::LCM& lcm, odomcalib::Odometry odometry) : lcm_(lcm), odometry_(std::move(odometry)) {}

  void on_ticks(const lcm::ReceiveBuffer* /*buffer*/, const std::string& /*channel*/,
                const odomcalib::ticks_t* ticks) {
    // The daemon says where counts cannot be continued.
    if (ticks->segment != segment_) odometry_.restart();
    segment_ = ticks->segment;
    if (odometry_.update_counts(1e-6 * static_cast<double>(ticks->utime), ticks->left, ticks->right) !=
        ODOMCALIB_OK)
      std::cerr << odometry_.problem() << '\n';
    const odomcalib::Pose pose = odometry_.pose();
    const odomcalib::pose_t message{ticks->utime, ticks->mono_ns, pose.x, pose.y, pose.yaw};
    lcm_.publish("CORRECTED_POSE", &message);
  }

 private:
  lcm::LCM& lcm_;
  odomcalib::Odometry odometry_;
  int segment_ = 0;
};

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: lcm_odometry CALIBRATION [CHANNEL_OF_TICKS [LCM_URL]]\n";
    return 1;
  }
  auto odometry = odomcalib::Odometry::open(argv[1]);
  if (!odometry) {
    std::cerr << odometry.error().text << '\n';
    return 1;
  }
  lcm::LCM lcm(argc > 3 ? argv[3] : "");
  if (!lcm.good()) {
    std::cerr << "no LCM: is there a route for multicast?\n";
    return 1;
  }
  Node node(lcm, std::move(*odometry));
  lcm.subscribe(argc > 2 ? argv[2] : "TICKS", &Node::on_ticks, &node);
  while (lcm.handle() == 0) {
  }
  return 0;
}
