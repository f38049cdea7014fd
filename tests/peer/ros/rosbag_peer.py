"""ROS 1's own rosbag (Debian: python3-rosbag) writes bags and reads those of the tests.

usage: rosbag_peer.py write DRIVE.jsonl OUT.bag none|bz2|lz4 whole|killed|shuffled
         killed: ended without an index, with a chunk that was not finished; shuffled: messages up to 0.4 s out of order
       rosbag_peer.py read FILE.bag     prints JSON Lines: wheels, scan, gyro
"""
import json
import math
import os
import signal
import sys

import genpy
import rosbag
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage

START = 1700000000  # s
LATENCY = 3000000  # ns


def time_of(t, late=0):
    return genpy.Time(START, round(t * 1e9) + late)


def with_header(message, t, frame):
    message.header.stamp = time_of(t)
    message.header.frame_id = frame
    return message


def set_pose(pose, line):
    pose.position.x, pose.position.y = line["x"], line["y"]
    pose.orientation.z, pose.orientation.w = math.sin(line["yaw"] / 2), math.cos(line["yaw"] / 2)


def messages(lines):
    rad = 2 * math.pi / next(line["ticks_per_rev"] for line in lines if line["type"] == "robot")
    for line in lines:
        t = line.get("t")
        if line["type"] == "ticks":
            joints = JointState(name=["wheel_right_joint", "wheel_left_joint"],
                                position=[rad * line["right"], rad * line["left"]])
            yield t, "/joint_states", with_header(joints, t, "")
            yield t, "/tf", TFMessage()
        elif line["type"] == "scan":
            scan = LaserScan(ranges=[math.inf if value is None else value for value in line["ranges"]])
            for name in ("angle_min", "angle_increment", "time_increment", "range_min", "range_max"):
                setattr(scan, name, line.get(name, 0.0))
            yield t, "/scan", with_header(scan, t, "laser")
        elif line["type"] == "gyro":
            imu = Imu()
            imu.angular_velocity.z = line["yaw_rate"]
            yield t, "/imu", with_header(imu, t, "imu")
        elif line["type"] == "pose":
            odometry = Odometry(child_frame_id="base_footprint")
            set_pose(odometry.pose.pose, line)
            yield t, "/odom", with_header(odometry, t, "odom")
            pose = PoseStamped()
            set_pose(pose.pose, line)
            yield t, "/mocap", with_header(pose, t, "map")


def write(drive, out, packing, end):
    with open(drive, encoding="utf-8") as file:
        found = list(messages([json.loads(line) for line in file]))
    found.sort(key=lambda one: one[0])
    if end == "shuffled":  # every second one 0.4 s later
        order = sorted(range(len(found)), key=lambda k: found[k][0] + 0.4 * (k % 2))
        found = [found[k] for k in order]
    bag = rosbag.Bag(out, "w", compression=packing, chunk_threshold=20000)
    for t, topic, message in found:
        bag.write(topic, message, time_of(t, LATENCY))
    if end == "killed":
        bag._file.flush()  # what the kernel has of a recorder that is killed
        os.kill(os.getpid(), signal.SIGKILL)
    bag.close()


def read(path):
    with rosbag.Bag(path) as bag:
        for topic, message, _ in bag.read_messages(topics=["/joint_states", "/scan", "/imu"]):
            stamp = message.header.stamp
            line = {"t": stamp.secs - START + stamp.nsecs / 1e9}
            if topic == "/joint_states":
                at = message.name.index
                line.update(type="wheels", left=message.position[at("wheel_left_joint")],
                            right=message.position[at("wheel_right_joint")])
            elif topic == "/scan":
                line["type"] = "scan"
                for name in ("angle_min", "angle_increment", "time_increment", "range_min", "range_max"):
                    line[name] = getattr(message, name)
                line["ranges"] = [value if math.isfinite(value) else None for value in message.ranges]
            else:
                line.update(type="gyro", yaw_rate=message.angular_velocity.z)
            print(json.dumps(line))


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](*sys.argv[2:])
