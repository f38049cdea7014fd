// The message definitions that both scripts use, and somebody else's encoders and decoders for them.
'use strict';
const ros1 = require('@foxglove/rosmsg-serialization');
const ros2 = require('@foxglove/rosmsg2-serialization');

const field = (text) => {
  const [type, name] = text.split(' ');
  const array = /^(.*)\[(\d*)\]$/.exec(type);
  const base = array ? array[1] : type;
  const out = { name, type: base, isComplex: base.includes('/') };
  if (array) {
    out.isArray = true;
    if (array[2]) out.arrayLength = Number(array[2]);
  }
  return out;
};

const TYPES = {
  'geometry_msgs/Point': ['float64 x', 'float64 y', 'float64 z'],
  'geometry_msgs/Vector3': ['float64 x', 'float64 y', 'float64 z'],
  'geometry_msgs/Quaternion': ['float64 x', 'float64 y', 'float64 z', 'float64 w'],
  'geometry_msgs/Pose': ['geometry_msgs/Point position', 'geometry_msgs/Quaternion orientation'],
  'geometry_msgs/Twist': ['geometry_msgs/Vector3 linear', 'geometry_msgs/Vector3 angular'],
  'geometry_msgs/PoseWithCovariance': ['geometry_msgs/Pose pose', 'float64[36] covariance'],
  'geometry_msgs/TwistWithCovariance': ['geometry_msgs/Twist twist', 'float64[36] covariance'],
  'geometry_msgs/PoseStamped': ['std_msgs/Header header', 'geometry_msgs/Pose pose'],
  'nav_msgs/Odometry': ['std_msgs/Header header', 'string child_frame_id', 'geometry_msgs/PoseWithCovariance pose',
                        'geometry_msgs/TwistWithCovariance twist'],
  'sensor_msgs/LaserScan': ['std_msgs/Header header', 'float32 angle_min', 'float32 angle_max', 'float32 angle_increment',
                            'float32 time_increment', 'float32 scan_time', 'float32 range_min', 'float32 range_max',
                            'float32[] ranges', 'float32[] intensities'],
  'sensor_msgs/JointState': ['std_msgs/Header header', 'string[] name', 'float64[] position', 'float64[] velocity',
                             'float64[] effort'],
  'sensor_msgs/Imu': ['std_msgs/Header header', 'geometry_msgs/Quaternion orientation', 'float64[9] orientation_covariance',
                      'geometry_msgs/Vector3 angular_velocity', 'float64[9] angular_velocity_covariance',
                      'geometry_msgs/Vector3 linear_acceleration', 'float64[9] linear_acceleration_covariance'],
};
const HEADER = { ros1: ['uint32 seq', 'time stamp', 'string frame_id'], ros2: ['builtin_interfaces/Time stamp', 'string frame_id'] };

/** The type first, then all others: encoders look up what they need by name. */
function definitions(type, ros) {
  const all = { ...TYPES, 'std_msgs/Header': HEADER[ros] };
  if (ros === 'ros2') all['builtin_interfaces/Time'] = ['int32 sec', 'uint32 nanosec'];
  const names = [type, ...Object.keys(all).filter((name) => name !== type)];
  return names.map((name, i) => ({ name: i === 0 && ros === 'ros1' ? undefined : name, definitions: all[name].map(field) }));
}

function writerFor(type, ros) {
  const Writer = (ros === 'ros1' ? ros1 : ros2).MessageWriter;
  const writer = new Writer(definitions(type, ros));
  return (message) => writer.writeMessage(message);
}

function readerFor(type, ros) {
  const Reader = (ros === 'ros1' ? ros1 : ros2).MessageReader;
  const reader = new Reader(definitions(type, ros));
  return (bytes) => reader.readMessage(bytes);
}

module.exports = { definitions, writerFor, readerFor };
