// A CANopen drive made of somebody else's CANopen stack (npm package canopen): SDO server, NMT, heartbeat, emergencies and
// process data are all theirs. Ours is the adapter at the other end of the pseudo-terminal (Lawicel ASCII) and a drive
// whose axes follow their commands at once.
//
// usage: NODE_PATH=.../node_modules node peer.js FD     FD: master of the pseudo-terminal
// One command a line on standard input: emcy CODE, clear, silence. Tells on standard output what it saw.
'use strict';
const fs = require('fs');
const readline = require('readline');
const { Device, Eds, DataType, ObjectType, AccessType } = require('canopen');

const port = Number(process.argv[2]);
const tell = (text) => fs.writeSync(1, text + '\n');

// ---- the drive's objects
const eds = new Eds();
const simple = (index, dataType, defaultValue, more = {}) =>
  eds.addEntry(index, { parameterName: index.toString(16), dataType, defaultValue, ...more });
const pair = (index, dataType, defaults, more = {}) => {
  const entry = eds.addEntry(index, { parameterName: index.toString(16), objectType: ObjectType.ARRAY });
  defaults.forEach((defaultValue, i) =>
    entry.addSubObject(i + 1, { parameterName: `${index.toString(16)}:${i + 1}`, dataType, defaultValue, ...more }));
  return entry;
};

eds.setIdentity({ vendorId: 0x0FEE, productCode: 0x0CA7, revisionNumber: 7, serialNumber: 60201 });
eds.setDeviceName('somebody else\'s stack');
// Their setHeartbeatProducerTime makes 1017h 32 bits wide; CiA 301 says 16.
simple(0x1017, DataType.UNSIGNED16, 500);
eds.addHeartbeatConsumer(0x7F, 10000);
eds.setEmcyCobId(0x81);
eds.addSdoServerParameter(0x7F, 0x581, 0x601);
const control = simple(0x6040, DataType.UNSIGNED16, 0);
const status = simple(0x6041, DataType.UNSIGNED32, 0x00400040);
const fault = simple(0x603F, DataType.UNSIGNED32, 0);
const mode = simple(0x6060, DataType.INTEGER8, 0);
const display = simple(0x6061, DataType.INTEGER8, 0);
simple(0x6007, DataType.INTEGER16, 1);
const position = pair(0x6064, DataType.INTEGER32, [0, 0], { pdoMapping: true });
const target = pair(0x60FF, DataType.INTEGER32, [0, 0], { pdoMapping: true });
pair(0x2100, DataType.UNSIGNED32, [150000, 150000, 400000], { lowLimit: 1000, highLimit: 1000000 });
simple(0x2200, DataType.UNSIGNED32, 1, { accessType: AccessType.READ_ONLY });
eds.addTransmitPdo({ cobId: 0x181, transmissionType: 254, eventTime: 50, dataObjects: [position[1], position[2]] });
eds.addTransmitPdo({ cobId: 0x281, transmissionType: 254, eventTime: 50, dataObjects: [status, fault] });
eds.addReceivePdo({ cobId: 0x201, dataObjects: [control] });
eds.addReceivePdo({ cobId: 0x301, dataObjects: [target[1], target[2]] });

// ---- the bus: slcan lines on the pseudo-terminal
let open = false;
const device = new Device({ id: 1, eds });
const say = (text) => { try { fs.writeSync(port, text); } catch (error) { /* nobody listens */ } };
const hex = (number, digits) => number.toString(16).toUpperCase().padStart(digits, '0');
device.addListener('message', ({ id, data, len }) => {
  const bytes = data.subarray(0, len === undefined ? data.length : len);
  if (open) say(`t${hex(id, 3)}${bytes.length}${bytes.toString('hex').toUpperCase()}\r`);
});
const onLine = (line) => {
  if (line === '') return say('\r');
  if (line[0] === 'O') open = true;
  if (line[0] === 'C') open = false;
  if (line[0] !== 't') return say('\r');
  say('\r');
  const length = parseInt(line[4], 16);
  device.receive({ id: parseInt(line.slice(1, 4), 16), len: length, data: Buffer.from(line.slice(5, 5 + 2 * length), 'hex') });
};
let rest = '';
const listen = () => fs.read(port, Buffer.alloc(4096), 0, 4096, null, (error, count, bytes) => {
  if (error && error.code !== 'EAGAIN' && error.code !== 'EIO') throw error;
  const lines = (rest + (error ? '' : bytes.toString('latin1', 0, count))).split('\r');
  rest = lines.pop();
  lines.forEach(onLine);
  setTimeout(listen, 1);
});

// ---- the drive: CiA 402 states, axes that follow
const kNext = { 0x40: { 0x06: 0x21 }, 0x21: { 0x07: 0x23, 0x00: 0x40 }, 0x23: { 0x0F: 0x27, 0x06: 0x21, 0x00: 0x40 },
  0x27: { 0x02: 0x07, 0x06: 0x21, 0x07: 0x23, 0x00: 0x40 }, 0x07: { 0x00: 0x40, 0x0F: 0x27 } };
let state = 0x40, told = '', last = process.hrtime.bigint();
const exact = [0, 0];
const step = () => {
  const now = process.hrtime.bigint(), seconds = Number(now - last) * 1e-9;
  last = now;
  display.value = mode.value;
  const next = (kNext[state] || {})[control.value & 0x0F];
  if (next !== undefined) state = next;
  status.value = state | (state << 16);
  for (const i of [0, 1]) {
    const rpm = state === 0x27 && mode.value === 3 ? 0.01 * target[i + 1].value : 0;
    exact[i] += rpm / 60 * 16384 * seconds;
    position[i + 1].value = Math.trunc(exact[i]);
  }
  const text = `state ${hex(state, 2)} target ${target[1].value} ${target[2].value}`;
  if (text !== told) tell(told = text);
};

device.nmt.addListener('timeout', (id) => tell(`timeout ${id}`));
device.nmt.addListener('heartbeat', ({ deviceId, state: told }) => tell(`heartbeat ${deviceId} ${told}`));
device.nmt.addListener('changeState', (nmt) => tell(`nmt ${nmt}`));
readline.createInterface({ input: process.stdin }).on('line', (line) => {
  const [verb, code] = line.split(' ');
  if (verb === 'emcy') device.emcy.write(parseInt(code, 16), Buffer.from([1, 2, 3, 4, 5]));
  if (verb === 'clear') device.emcy.write(0, Buffer.alloc(5));
  if (verb === 'silence') device.stop();
}).on('close', () => process.exit(0));

device.start();
setInterval(step, 2);
listen();
tell('ready');
