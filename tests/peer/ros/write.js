// Writes a recording (JSON Lines) as an MCAP file or a rosbag2 database with somebody else's writers, message definitions,
// encoders and compressors: npm packages @mcap/core, @foxglove/sql.js, @foxglove/rosmsg-msgs-common,
// @foxglove/rosmsg-serialization, @foxglove/rosmsg2-serialization, lz4js, @foxglove/wasm-zstd.
//
// usage: NODE_PATH=.../node_modules node write.js DRIVE.jsonl OUT.mcap ros1|ros2 none|lz4|zstd whole|bare
//        whole: chunks, index and summary; bare: no chunks, no summary
//        NODE_PATH=.../node_modules node write.js DRIVE.jsonl OUT.db3 ros2 none|zstd
//        zstd: each message alone
'use strict';
const fs = require('fs');
const { McapWriter } = require('@mcap/core');
const lz4 = require('lz4js');
const zstd = require('@foxglove/wasm-zstd');
const { definitions, writerFor } = require('./messages.js');
const { newDatabase } = require('./sqlite.js');

const [drive, out, ros, packing, layout] = process.argv.slice(2);
const START = 1700000000n * 1000000000n;  // ns
const LATENCY = 3000000n;

class File {
  constructor(path) { this.fd = fs.openSync(path, 'w'); this.size = 0n; }
  position() { return this.size; }
  async write(bytes) { fs.writeSync(this.fd, bytes); this.size += BigInt(bytes.length); }
}

const compressors = {
  none: undefined,
  lz4: (data) => ({ compression: 'lz4', compressedData: lz4.compress(data) }),
  zstd: (data) => ({ compression: 'zstd', compressedData: zstd.compress(data, 3) }),
};

const ns = (t) => START + BigInt(Math.round(t * 1e9));
const header = (time, frame) => {
  const seconds = Number(time / 1000000000n), rest = Number(time % 1000000000n);
  return ros === 'ros1' ? { seq: 0, stamp: { sec: seconds, nsec: rest }, frame_id: frame }
                        : { stamp: { sec: seconds, nanosec: rest }, frame_id: frame };
};

function messages(lines) {
  const robot = lines.find((line) => line.type === 'robot');
  const rad = 2 * Math.PI / robot.ticks_per_rev;
  const list = [];
  for (const line of lines) {
    const time = line.t === undefined ? 0n : ns(line.t);
    if (line.type === 'ticks')
      list.push(['/joint_states', 'sensor_msgs/JointState', time, {
        header: header(time, ''), name: ['wheel_right_joint', 'wheel_left_joint'],
        position: [rad * line.right, rad * line.left], velocity: [], effort: [] }]);
    if (line.type === 'scan')
      list.push(['/scan', 'sensor_msgs/LaserScan', time, {
        header: header(time, 'laser'), angle_min: line.angle_min, angle_max: 0, angle_increment: line.angle_increment,
        time_increment: line.time_increment || 0, scan_time: 0.1, range_min: line.range_min, range_max: line.range_max,
        ranges: line.ranges.map((range) => range === null ? Infinity : range), intensities: [] }]);
    if (line.type === 'gyro')
      list.push(['/imu', 'sensor_msgs/Imu', time, {
        header: header(time, 'imu'), orientation: { x: 0, y: 0, z: 0, w: 1 }, orientation_covariance: new Array(9).fill(0),
        angular_velocity: { x: 0.25, y: -0.5, z: line.yaw_rate }, angular_velocity_covariance: new Array(9).fill(0),
        linear_acceleration: { x: 0, y: 0, z: 9.81 }, linear_acceleration_covariance: new Array(9).fill(0) }]);
    if (line.type === 'pose')
      for (const [topic, type] of [['/odom', 'nav_msgs/Odometry'], ['/mocap', 'geometry_msgs/PoseStamped']]) {
        const pose = { position: { x: line.x, y: line.y, z: 0 },
                       orientation: { x: 0, y: 0, z: Math.sin(line.yaw / 2), w: Math.cos(line.yaw / 2) } };
        const zero = { x: 0, y: 0, z: 0 }, none = new Array(36).fill(0);
        list.push([topic, type, time, type === 'geometry_msgs/PoseStamped' ? { header: header(time, 'map'), pose } : {
          header: header(time, 'odom'), child_frame_id: 'base_footprint', pose: { pose, covariance: none },
          twist: { twist: { linear: zero, angular: zero }, covariance: none } }]);
      }
  }
  return list;
}

const recorded = () => messages(
  fs.readFileSync(drive, 'utf8').split('\n').filter((line) => line).map((line) => JSON.parse(line)));
const typeName = (type) => ros === 'ros1' ? type : type.replace('/', '/msg/');

async function writeMcap() {
  const whole = layout === 'whole';
  const writer = new McapWriter({
    writable: new File(out), useChunks: whole, useSummaryOffsets: whole, useStatistics: whole, useChunkIndex: whole,
    useMessageIndex: whole, repeatChannels: whole, repeatSchemas: whole, chunkSize: 20000, compressChunk: compressors[packing] });
  await writer.start({ profile: ros, library: 'peer' });
  const channels = new Map();
  let sequence = 0;
  for (const [topic, type, time, message] of recorded()) {
    if (!channels.has(topic)) {
      const schemaId = await writer.registerSchema({
        name: typeName(type), encoding: ros === 'ros1' ? 'ros1msg' : 'ros2msg',
        data: Buffer.from(JSON.stringify(definitions(type, ros)[0])) });
      channels.set(topic, { encode: writerFor(type, ros), id: await writer.registerChannel({
        schemaId, topic, messageEncoding: ros === 'ros1' ? 'ros1' : 'cdr', metadata: new Map() }) });
    }
    const channel = channels.get(topic);
    await writer.addMessage({ channelId: channel.id, sequence: sequence++, publishTime: time, logTime: time + LATENCY,
                              data: channel.encode(message) });
  }
  await writer.end();
}

// The tables that rosbag2_storage_sqlite3 makes.
const TABLES = `
  CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
  INSERT INTO schema VALUES(3, 'humble');
  CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
  CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
                      offered_qos_profiles TEXT NOT NULL);
  CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
  CREATE INDEX timestamp_idx ON messages (timestamp ASC);`;

async function writeDatabase() {
  const database = await newDatabase();
  database.run(TABLES);
  const topics = new Map();
  for (const [name, type, time, message] of recorded()) {
    if (!topics.has(name)) {
      topics.set(name, { id: topics.size + 1, encode: writerFor(type, ros) });
      database.run("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", [topics.size, name, typeName(type)]);
    }
    const topic = topics.get(name), bytes = topic.encode(message);
    database.run('INSERT INTO messages(topic_id, timestamp, data) VALUES(?, CAST(? AS INTEGER), ?)',
      [topic.id, String(time + LATENCY), packing === 'zstd' ? zstd.compress(bytes, 3) : bytes]);
  }
  fs.writeFileSync(out, database.export());
}

zstd.isLoaded.then(out.endsWith('.db3') ? writeDatabase : writeMcap)
  .catch((error) => { console.error(error); process.exit(1); });
