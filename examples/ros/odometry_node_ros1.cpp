// Node for ROS 1: joint_states in; odom (nav_msgs/Odometry with covariances) and tf from odom to base_link
// out. Parameters: ~calibration (file), ~left_joint, ~right_joint, ~odom_frame, ~base_frame.
//
//   c++ -std=c++17 odometry_node_ros1.cpp -o odometry_node
//     with $(pkg-config --cflags --libs roscpp nav_msgs sensor_msgs tf2_ros odomcalib)
//   ./odometry_node _calibration:=cal.json _left_joint:=left_wheel _right_joint:=right_wheel
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>

#include "joint_odometry.hpp"

class Node {
 public:
  Node(ros::NodeHandle& node, JointOdometry odometry, std::string odom_frame, std::string base_frame)
      : odometry_(std::move(odometry)),
        odom_frame_(std::move(odom_frame)),
        base_frame_(std::move(base_frame)),
        publisher_(node.advertise<nav_msgs::Odometry>("odom", 50)),
        subscriber_(node.subscribe("joint_states", 50, &Node::on_joints, this)) {}

 private:
  void on_joints(const sensor_msgs::JointState::ConstPtr& joints) {
    if (!odometry_.update(joints->header.stamp.toSec(), joints->name, joints->position)) {
      ROS_WARN_THROTTLE(5.0, "joint states were not used: %s", odometry_.problem());
      return;
    }
    publish(joints->header.stamp);
  }

  void publish(const ros::Time& stamp) {
    const odomcalib::Pose pose = odometry_.pose();
    const odomcalib::Velocity velocity = odometry_.velocity();
    const auto [z, w] = odometry_.heading();

    nav_msgs::Odometry odometry;
    odometry.header.stamp = stamp;
    odometry.header.frame_id = odom_frame_;
    odometry.child_frame_id = base_frame_;
    odometry.pose.pose.position.x = pose.x;
    odometry.pose.pose.position.y = pose.y;
    odometry.pose.pose.orientation.z = z;
    odometry.pose.pose.orientation.w = w;
    odometry.twist.twist.linear.x = velocity.forward;
    odometry.twist.twist.linear.y = velocity.left;
    odometry.twist.twist.angular.z = velocity.yaw_rate;
    const Covariance36 of_pose = odometry_.pose_covariance(), of_velocity = odometry_.velocity_covariance();
    std::copy(of_pose.begin(), of_pose.end(), odometry.pose.covariance.begin());
    std::copy(of_velocity.begin(), of_velocity.end(), odometry.twist.covariance.begin());
    publisher_.publish(odometry);

    geometry_msgs::TransformStamped transform;
    transform.header = odometry.header;
    transform.child_frame_id = base_frame_;
    transform.transform.translation.x = pose.x;
    transform.transform.translation.y = pose.y;
    transform.transform.rotation = odometry.pose.pose.orientation;
    broadcaster_.sendTransform(transform);
  }

  JointOdometry odometry_;
  std::string odom_frame_, base_frame_;
  ros::Publisher publisher_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Subscriber subscriber_;
};

int main(int argc, char** argv) {
  ros::init(argc, argv, "odomcalib_odometry");
  ros::NodeHandle node, own("~");
  auto odometry = odomcalib::Odometry::open(own.param<std::string>("calibration", ""));
  if (!odometry) {
    ROS_FATAL("%s", odometry.error().text.c_str());
    return 1;
  }
  JointOdometry joints(std::move(*odometry), own.param<std::string>("left_joint", "left_wheel_joint"),
                       own.param<std::string>("right_joint", "right_wheel_joint"));
  const Node running(node, std::move(joints), own.param<std::string>("odom_frame", "odom"),
                     own.param<std::string>("base_frame", "base_link"));
  ros::spin();
  return 0;
}
