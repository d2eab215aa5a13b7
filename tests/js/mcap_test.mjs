// Our recordings as the reference library of the format reads them: by index and as a stream, with every checksum, in each
// compression; counts are rate times time, and a LaserScan decodes to the ranges that the run itself wrote as CSV, and that
// the recording exports as CSV.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { open } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";
import { loadDecompressHandlers } from "@mcap/support";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const sandlot = `${process.env.SANDLOT_BUILD ?? "build/release"}/sandlot`;
const decompressHandlers = await loadDecompressHandlers();

// Rows of a CSV file by their time, as single precision numbers.
function table(file) {
  const number = (text) => text === "inf" ? Infinity : text === "-inf" ? -Infinity : Math.fround(Number(text));
  return new Map(readFileSync(file, "utf8").trim().split("\n").slice(1).map((line) => {
    const [time, ...values] = line.split(",");
    return [String(Number(time)), values.map(number)];
  }));
}

for (const compression of ["none", "lz4", "zstd"]) {
  test(`a recording with compression ${compression}`, async () => {
    const folder = mkdtempSync(join(tmpdir(), "sandlot-js-"));
    const file = join(folder, "r.mcap");
    const log = join(folder, "log.csv"), exported = join(folder, "exported.csv");
    const beamsLogged = [0, 17, 90, 135, 179];
    const run = (...more) => JSON.parse(execFileSync(sandlot, ["run", "scenarios/indoor.yaml", "--duration", "10s", "--json",
      ...more], { stdio: "pipe" })).state_hash;
    const hash = run("--record", file, "--record-compression", compression, "--log", log,
      "--log-values", beamsLogged.map((i) => `rover/laser.ranges[${i}]`).join(","));
    assert.equal(hash, run(), "recording changes nothing");
    execFileSync(sandlot, ["topic", "export", file, "--out", exported,
      "--values", beamsLogged.map((i) => `/rover/laser/ranges.ranges[${i}]`).join(",")], { stdio: "pipe" });
    const logged = table(log), fromRecording = table(exported);

    const handle = await open(file, "r");
    const indexed = await McapIndexedReader.Initialize(
      { readable: new FileHandleReadable(handle), decompressHandlers });
    assert.equal(indexed.header.profile, "ros2");
    const counts = new Map();
    let last = 0n, scans = 0;
    for await (const message of indexed.readMessages({ validateCrcs: true })) {
      const channel = indexed.channelsById.get(message.channelId);
      counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
      assert.ok(message.logTime >= last);
      last = message.logTime;
      if (channel.topic !== "/rover/laser/ranges") continue;
      const schema = indexed.schemasById.get(channel.schemaId);
      assert.equal(schema.encoding, "ros2msg");
      const types = parse(new TextDecoder().decode(schema.data), { ros2: true });
      const scan = new MessageReader(types).readMessage(message.data);
      assert.equal(BigInt(scan.header.stamp.sec) * 1000000000n + BigInt(scan.header.stamp.nsec), message.logTime);
      assert.equal(scan.header.frame_id, "rover/laser");
      const beams = Math.round((scan.angle_max - scan.angle_min) / scan.angle_increment) + 1;
      assert.equal(scan.ranges.length, beams);
      const time = String(Number(message.logTime) / 1e9);
      const seen = beamsLogged.map((i) => scan.ranges[i]);
      assert.deepEqual(logged.get(time), seen, `the run's own CSV at ${time} s`);
      assert.deepEqual(fromRecording.get(time), seen, `the exported CSV at ${time} s`);
      assert.ok(scan.ranges.every((r) => r === Infinity || r === -Infinity || (r > 0 && r <= scan.range_max)));
      ++scans;
    }
    assert.equal(scans, 101, "10 Hz for 10 s, and that of the beginning");
    assert.equal(counts.get("/rover/drive/ideal"), 501, "50 Hz for 10 s, and that of the beginning");
    assert.equal(counts.get("/sandlot/hash"), 1001, "one per tick, and that of the beginning");
    const names = [];
    for await (const attachment of indexed.readAttachments({ validateCrcs: true })) names.push(attachment.name);
    assert.deepEqual(names.sort(), ["scenario", "snapshot"]);
    await handle.close();

    const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
    stream.append(readFileSync(file));
    let streamed = 0n;
    for (let record; (record = stream.nextRecord());) if (record.type === "Message") ++streamed;
    assert.ok(stream.done());
    assert.equal(streamed, indexed.statistics.messageCount);
    rmSync(folder, { recursive: true });
  });
}
