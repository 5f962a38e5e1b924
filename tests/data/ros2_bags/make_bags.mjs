// SPDX-License-Identifier: Apache-2.0
// Writes the bags of this folder with writers that are independent of dfdyn: @mcap/core 2.2.2 (MCAP),
// @foxglove/rosmsg2-serialization (CDR), and the programs lz4, zstd and sqlite3 of Debian 12.
//   npm install @mcap/core@2.2.2 @foxglove/rosmsg2-serialization @foxglove/rosmsg && node make_bags.mjs
import { execFileSync } from "node:child_process";
import { rmSync, writeFileSync } from "node:fs";
import { McapWriter } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import rosmsg2 from "@foxglove/rosmsg2-serialization";

const time = "int32 sec\nuint32 nanosec\n";
const header = "builtin_interfaces/Time stamp\nstring frame_id\n";
const line = "=".repeat(80) + "\n";
const definitions = {
  "sensor_msgs/msg/JointState":
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
  "geometry_msgs/msg/WrenchStamped":
    "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n" + line +
    "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n" + line +
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
  "std_msgs/msg/String": "string data\n",
};
const common = line + "MSG: std_msgs/Header\n" + header + line + "MSG: builtin_interfaces/Time\n" + time;
const writers = {};
for (const [type, text] of Object.entries(definitions)) {
  if (type !== "std_msgs/msg/String") {
    definitions[type] = text + common;
  }
  writers[type] = new rosmsg2.MessageWriter(parse(definitions[type], { ros2: true }));
}

// Message k: joint j is at sin(k / 10 + j); the wrench is linear in time.
const begin = 1700000000n * 1000000000n;
const stamp = (ns) => ({ sec: Number(ns / 1000000000n), nanosec: Number(ns % 1000000000n) });
const messages = [];
const add = (topic, type, ns, message) =>
  messages.push({ topic, type, ns, data: writers[type].writeMessage(message) });
for (let k = 0; k < 40; ++k) {
  const ns = begin + BigInt(k) * 10000000n;
  const joints = [2, 0, 9, 1]; // elbow, base, gripper, wrist: not the order of the chain
  add("/joint_states", "sensor_msgs/msg/JointState", ns, {
    header: { stamp: stamp(ns), frame_id: "base_link" },
    name: ["elbow", "base", "gripper", "wrist"],
    position: joints.map((j) => Math.sin(k / 10 + j)),
    velocity: joints.map((j) => 10 * Math.cos(k / 10 + j)),
    effort: joints.map((j) => 100 * j + k),
  });
  if (k % 2 === 0) { // every 20 ms, 4 ms later
    const later = ns + 4000000n;
    const t = k / 100 + 0.004;
    add("/ft/wrench", "geometry_msgs/msg/WrenchStamped", later, {
      header: { stamp: stamp(later), frame_id: "ft" },
      wrench: { force: { x: 1 + t, y: 2 + t, z: 3 + t }, torque: { x: 4 + t, y: 5 + t, z: 6 + t } },
    });
  }
  add("/log", "std_msgs/msg/String", ns, { data: "message " + k });
}

class Memory {
  parts = [];
  size = 0n;
  position() { return this.size; }
  async write(bytes) { this.parts.push(Buffer.from(bytes)); this.size += BigInt(bytes.length); }
}

async function writeMcap(file, compression) {
  const memory = new Memory();
  const filter = { lz4: ["lz4", ["-c", "-q"]], zstd: ["zstd", ["-c", "-q"]] }[compression];
  const writer = new McapWriter({
    writable: memory,
    chunkSize: 4000,
    compressChunk: filter && ((bytes) => ({ compression, compressedData: execFileSync(...filter, { input: bytes }) })),
  });
  await writer.start({ profile: "ros2", library: "" });
  const channels = {};
  for (const { topic, type, ns, data } of messages) {
    if (channels[topic] === undefined) {
      const schemaId = await writer.registerSchema({ name: type, encoding: "ros2msg", data: Buffer.from(definitions[type]) });
      channels[topic] = await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() });
    }
    await writer.addMessage({ channelId: channels[topic], sequence: 0, logTime: ns, publishTime: ns, data });
  }
  await writer.end();
  writeFileSync(file, Buffer.concat(memory.parts));
}

function writeSqlite(file) {
  const topics = [...new Set(messages.map((m) => m.topic))];
  const rows = ["CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);",
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);"];
  topics.forEach((topic, k) =>
    rows.push(`INSERT INTO topics VALUES(${k + 1},'${topic}','${messages.find((m) => m.topic === topic).type}','cdr','');`));
  messages.forEach(({ topic, ns, data }, k) =>
    rows.push(`INSERT INTO messages VALUES(${k + 1},${topics.indexOf(topic) + 1},${ns},x'${Buffer.from(data).toString("hex")}');`));
  rmSync(file, { force: true });
  execFileSync("sqlite3", [file], { input: rows.join("\n") });
}

await writeMcap("plain.mcap");
await writeMcap("lz4.mcap", "lz4");
await writeMcap("zstd.mcap", "zstd");
writeSqlite("sqlite.db3");
