// Reads a bag (npm package rosbag), a rosbag2 database (@foxglove/rosbag2-web) or an MCAP file (@mcap/core) with somebody
// else's readers, decoders and message definitions, and prints what it holds as JSON Lines: {"type":"wheels",...} of joint
// states, {"type":"scan",...} of scans, {"type":"gyro",...}.
//
// usage: NODE_PATH=.../node_modules node read.js FILE.bag|FILE.db3|FILE.mcap
'use strict';
const fs = require('fs');
const { execFileSync } = require('child_process');
const { McapStreamReader } = require('@mcap/core');
const { open } = require('rosbag');
const lz4 = require('lz4js');
const zstd = require('@foxglove/wasm-zstd');
const { md5Of, readerFor } = require('./messages.js');
const { openRosbag2 } = require('./sqlite.js');

const file = process.argv[2];
// npm has no bz2 decompressor that runs as it is; Python's is at hand.
const bunzip2 = (packed) => execFileSync('python3',
  ['-c', 'import bz2,sys; sys.stdout.buffer.write(bz2.decompress(sys.stdin.buffer.read()))'], { input: packed });

function tell(type, message) {
  const { stamp } = message.header;
  const nanoseconds = stamp.nsec === undefined ? stamp.nanosec : stamp.nsec;
  const line = { t: stamp.sec - 1700000000 + nanoseconds / 1e9 };
  if (type === 'sensor_msgs/JointState') {
    line.type = 'wheels';
    line.left = message.position[message.name.indexOf('wheel_left_joint')];
    line.right = message.position[message.name.indexOf('wheel_right_joint')];
  } else if (type === 'sensor_msgs/LaserScan') {
    line.type = 'scan';
    for (const name of ['angle_min', 'angle_increment', 'time_increment', 'range_min', 'range_max']) line[name] = message[name];
    line.ranges = Array.from(message.ranges, (range) => Number.isFinite(range) ? range : null);
  } else if (type === 'sensor_msgs/Imu') {
    line.type = 'gyro';
    line.yaw_rate = message.angular_velocity.z;
  } else {
    return;
  }
  process.stdout.write(JSON.stringify(line) + '\n');
}

async function readBag() {
  const bag = await open(file);
  const types = {};
  for (const { topic, type, md5sum } of Object.values(bag.connections)) {
    types[topic] = type;
    if (md5sum !== md5Of(type)) throw new Error(`${topic}: ${md5sum} is not the MD5 of ${type}`);
  }
  const decompress = { lz4: (packed) => Buffer.from(lz4.decompress(packed)), bz2: bunzip2 };
  await bag.readMessages({ decompress }, ({ topic, message }) => { if (message.header) tell(types[topic], message); });
}

async function readDatabase() {
  const bag = await openRosbag2(file);
  for await (const { topic, value } of bag.readMessages()) if (value.header) tell(topic.type.replace('/msg/', '/'), value);
}

async function readMcap() {
  await zstd.isLoaded;
  const reader = new McapStreamReader({ decompressHandlers: {
    lz4: (packed) => lz4.decompress(packed), zstd: (packed, size) => zstd.decompress(packed, Number(size)) } });
  reader.append(fs.readFileSync(file));
  const schemas = new Map(), channels = new Map();
  for (let record; (record = reader.nextRecord());) {
    if (record.type === 'Schema') schemas.set(record.id, record);
    if (record.type === 'Channel') {
      const type = schemas.get(record.schemaId).name.replace('/msg/', '/');
      const known = type.startsWith('sensor_msgs/');
      channels.set(record.id, { type, decode: known && readerFor(type, record.messageEncoding === 'ros1' ? 'ros1' : 'ros2') });
    }
    if (record.type === 'Message') {
      const channel = channels.get(record.channelId);
      if (channel.decode) tell(channel.type, channel.decode(record.data));
    }
  }
  if (!reader.done()) throw new Error('the file does not end where it should');
}

const read = { bag: readBag, db3: readDatabase, mcap: readMcap }[file.split('.').pop()];
read().catch((error) => { console.error(error); process.exit(1); });
