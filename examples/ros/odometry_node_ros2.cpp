// Node for ROS 2: the one for ROS 1 but for the lines that touch rclcpp. It is neither built nor run by the
// tests of this project: rclcpp is not in Debian. Parameters: calibration (file), left_joint, right_joint,
// odom_frame, base_frame.
#include <tf2_ros/transform_broadcaster.h>

#include <algorithm>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "joint_odometry.hpp"

class Node : public rclcpp::Node {
 public:
  Node()
      : rclcpp::Node("odomcalib_odometry"),
        odometry_(opened()),
        odom_frame_(declare_parameter<std::string>("odom_frame", "odom")),
        base_frame_(declare_parameter<std::string>("base_frame", "base_link")),
        publisher_(create_publisher<nav_msgs::msg::Odometry>("odom", 50)),
        broadcaster_(*this),
        subscriber_(create_subscription<sensor_msgs::msg::JointState>(
            "joint_states", rclcpp::SensorDataQoS(),
            [this](const sensor_msgs::msg::JointState::ConstSharedPtr& joints) { on_joints(*joints); })) {}

 private:
  JointOdometry opened() {
    auto odometry = odomcalib::Odometry::open(declare_parameter<std::string>("calibration", ""));
    if (!odometry) throw std::runtime_error(odometry.error().text);
    return {std::move(*odometry), declare_parameter<std::string>("left_joint", "left_wheel_joint"),
            declare_parameter<std::string>("right_joint", "right_wheel_joint")};
  }

  void on_joints(const sensor_msgs::msg::JointState& joints) {
    if (!odometry_.update(rclcpp::Time(joints.header.stamp).seconds(), joints.name, joints.position)) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 5000, "joint states were not used: %s",
                           odometry_.problem());
      return;
    }
    publish(joints.header.stamp);
  }

  void publish(const builtin_interfaces::msg::Time& stamp) {
    const odomcalib::Pose pose = odometry_.pose();
    const odomcalib::Velocity velocity = odometry_.velocity();
    const auto [z, w] = odometry_.heading();

    nav_msgs::msg::Odometry odometry;
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
    publisher_->publish(odometry);

    geometry_msgs::msg::TransformStamped transform;
    transform.header = odometry.header;
    transform.child_frame_id = base_frame_;
    transform.transform.translation.x = pose.x;
    transform.transform.translation.y = pose.y;
    transform.transform.rotation = odometry.pose.pose.orientation;
    broadcaster_.sendTransform(transform);
  }

  JointOdometry odometry_;
  std::string odom_frame_, base_frame_;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr publisher_;
  tf2_ros::TransformBroadcaster broadcaster_;
  rclcpp::Subscription<sensor_msgs::msg::JointState>::SharedPtr subscriber_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Node>());
  rclcpp::shutdown();
  return 0;
}
