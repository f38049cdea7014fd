// SQLite as somebody else compiled it, with the rosbag2 reader on top of it.
'use strict';
const fs = require('fs');
globalThis.File ??= class {};  // the reader asks whether it was given one, which Node.js before 20 does not know
const { Rosbag2, SqliteSqljs } = require('@foxglove/rosbag2-web');

const wasmBinary = () => fs.readFileSync(require.resolve('@foxglove/sql.js/dist/sql-wasm.wasm'));

/** A new database in memory. */
async function newDatabase() {
  const SQL = await SqliteSqljs.Initialize({ wasmBinary: wasmBinary() });
  return new SQL.Database();
}

async function openRosbag2(file) {
  await SqliteSqljs.Initialize({ wasmBinary: wasmBinary() });
  const bag = new Rosbag2([new SqliteSqljs(new Uint8Array(fs.readFileSync(file)))]);
  await bag.open();
  return bag;
}

module.exports = { newDatabase, openRosbag2 };
