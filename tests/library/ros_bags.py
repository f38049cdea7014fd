"""Bags for the test of the node: ros_bags.py write BAG (counts as JSON on standard input), or read BAG (odom as JSON)."""

import json
import math
import sys

import rosbag
import rospy
from sensor_msgs.msg import JointState


def write(name):
    drive = json.load(sys.stdin)
    per_count = 2.0 * math.pi / drive["counts_per_turn"]
    with rosbag.Bag(name, "w") as bag:
        for stamp, left, right in drive["ticks"]:
            message = JointState(name=["arm", "left", "right"], position=[0.5, per_count * left, per_count * right])
            message.header.stamp = rospy.Time.from_sec(stamp)
            # A bag knows no time zero.
            bag.write("/joint_states", message, rospy.Time.from_sec(stamp + 1.0))


def read(name):
    poses, transforms = [], 0
    with rosbag.Bag(name) as bag:
        for topic, message, _ in bag.read_messages():
            transforms += topic == "/tf"
            if topic == "/odom":
                place = message.pose.pose.position
                poses.append((message.header.stamp.to_sec(), place.x, place.y, message.pose.covariance[35]))
    assert abs(transforms - len(poses)) <= 2, "a transform for each pose"
    json.dump(poses, sys.stdout)


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](sys.argv[2])
