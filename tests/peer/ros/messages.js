// Somebody else's message definitions, and encoders and decoders for them.
'use strict';
const ros1 = require('@foxglove/rosmsg-serialization');
const ros2 = require('@foxglove/rosmsg2-serialization');
const { md5 } = require('@foxglove/rosmsg');
const common = require('@foxglove/rosmsg-msgs-common');

/** The type first, then all others: encoders look up what they need by name. */
function definitions(type, ros) {
  if (ros === 'ros1') return [{ definitions: common.ros1[type].definitions }, ...Object.values(common.ros1)];
  const all = common.ros2humble;
  return [all[type], ...Object.values(all).filter((one) => one.name !== type)];
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

const md5Of = (type) => md5(definitions(type, 'ros1'));

module.exports = { definitions, md5Of, writerFor, readerFor };
