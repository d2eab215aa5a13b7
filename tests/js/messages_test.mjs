// Holds every message type against readers that others wrote: what our CDR says by our schema (@foxglove/rosmsg,
// @foxglove/rosmsg2-serialization) is what our JSON says; written again it is the same bytes; and our schemas are those
// of ROS 2 Humble (@foxglove/rosmsg-msgs-common).
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { parse } from "@foxglove/rosmsg";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";

const build = process.env.SANDLOT_BUILD ?? "build/release";
const file = `${build}/js/messages.jsonl`;
mkdirSync(`${build}/js`, { recursive: true });
execFileSync(`${build}/messages_tests`, ["--gtest_filter=Samples.*"],
  { env: { ...process.env, SANDLOT_SAMPLES: file }, stdio: "pipe" });
const samples = readFileSync(file, "utf8").trim().split("\n").map((line) => JSON.parse(line));

const short = (name) => name.replace("/msg/", "/");

/** The value of our JSON text in the form that the reader gives. */
function expected(definitions, type, value) {
  if (type === "time" || type === "duration") return { sec: value.sec, nsec: value.nanosec };
  const out = {};
  for (const field of definitions.find((d) => d.name === type).definitions) {
    if (field.isConstant) continue;
    const one = (v) => {
      if (field.isComplex || field.type === "time" || field.type === "duration")
        return expected(definitions, field.type, v);
      if (field.type === "float32") return Math.fround(v);
      return field.type.endsWith("int64") ? BigInt(v) : v;
    };
    const given = value[field.name];
    assert.notEqual(given, undefined, `${type}.${field.name} is missing in our JSON`);
    if (!field.isArray) out[field.name] = one(given);
    else if (typeof given === "string") out[field.name] = [...Buffer.from(given, "base64")];
    else out[field.name] = given.map(one);
  }
  for (const key of Object.keys(value)) assert.ok(key in out, `${type} has no field ${key}`);
  return out;
}

/** Typed arrays and objects of classes as plain values. */
function plain(value) {
  if (ArrayBuffer.isView(value)) return Array.from(value);
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, member]) => [key, plain(member)]));
}

/** JSON.parse without loss: integers beyond 2^53 become BigInt. */
const parseExact = (text) => JSON.parse(text.replace(/([:[,])(-?\d{16,})(?=[,}\]])/g, '$1"$2"'));

function rootOf(definitions, name) {
  return definitions.find((d) => d.name === undefined || d.name === short(name));
}

for (const { name, schema, cdr, json } of samples) {
  test(name, () => {
    const definitions = parse(schema, { ros2: true });
    const root = rootOf(definitions, name);
    root.name = undefined;
    const bytes = Uint8Array.from(Buffer.from(cdr, "hex"));
    // What has no fields is one byte in ROS 2; their reader knows no such messages.
    if (root.definitions.every((d) => d.isConstant)) return assert.deepEqual([...bytes], [0, 1, 0, 0, 0]);
    const read = new MessageReader(definitions).readMessage(bytes);
    root.name = short(name);
    assert.deepEqual(plain(read), plain(expected(definitions, root.name, parseExact(json))));
    if (cdr.includes("c3a4")) return; // their writer counts the letters of a string, not its bytes
    root.name = undefined;
    const again = new MessageWriter(definitions).writeMessage(read);
    assert.equal(Buffer.from(again).toString("hex"), cdr);
  });
}

test("schemas are those of ROS 2 Humble", () => {
  const ours = new Map();
  for (const { name, schema } of samples) ours.set(short(name), rootOf(parse(schema, { ros2: true }), name).definitions);
  const missing = [];
  for (const [name, theirs] of Object.entries(ros2humble)) {
    const packages = /^(std_msgs|geometry_msgs|sensor_msgs|nav_msgs|tf2_msgs|rosgraph_msgs|diagnostic_msgs|trajectory_msgs)\//;
    if (!ours.has(name)) {
      if (packages.test(name)) missing.push(name);
      continue;
    }
    const facts = (d) => d.map(({ name: n, type, isArray, arrayLength, arrayUpperBound, isConstant, value }) =>
      ({ n, type, isArray: isArray ?? false, arrayLength, arrayUpperBound, isConstant: isConstant ?? false, value }));
    const fields = (d) => facts(d).filter((f) => !f.isConstant);
    const constants = (d) => facts(d).filter((f) => f.isConstant);
    assert.deepEqual(fields(ours.get(name)), fields(theirs.definitions), name);
    assert.deepEqual(constants(ours.get(name)), constants(theirs.definitions), name);
  }
  assert.deepEqual(missing, []);
});
