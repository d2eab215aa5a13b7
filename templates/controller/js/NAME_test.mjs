// Runs @NAME@.yaml with the program, twice. SANDLOT names the command where it is not in PATH.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { decide } from "./@NAME@_controller.mjs";

const cwd = fileURLToPath(new URL(".", import.meta.url));

/** The summary of a run as fast as it goes. */
async function run() {
  const folder = mkdtempSync(join(tmpdir(), "@NAME@-"));
  try {
    const file = join(folder, "summary.json");
    const server = spawn(process.env.SANDLOT ?? "sandlot", ["run", "@NAME@.yaml", "--port", "0", "--rate", "max", "--summary", file],
      { cwd, stdio: ["ignore", "ignore", "pipe"] });
    const ended = once(server, "close");
    let address = "", said = "";
    for await (const line of createInterface(server.stderr)) {
      said += line + "\n";
      if (!line.startsWith("page: ")) continue;
      address = line.slice(6);
      break;
    }
    assert.ok(address, said);
    server.stderr.resume();
    const program = spawn(process.execPath, ["@NAME@_controller.mjs"], { cwd, stdio: "inherit", env: { ...process.env, SANDLOT_URL: address } });
    assert.equal((await once(program, "close"))[0], 0);
    assert.equal((await ended)[0], 0);
    return JSON.parse(readFileSync(file, "utf8"));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

test("it turns to the side with more room", () => {
  const ranges = Array(271).fill(null);
  assert.deepEqual(decide({ ranges, range_max: 8 }), { linear: { x: 0.4 } });
  ranges[135] = 0.3;  // ahead
  ranges[90] = 1;  // to the right
  assert.deepEqual(decide({ ranges, range_max: 8 }), { angular: { z: 1 } });
});

test("it arrives, and does so again", async () => {
  const [first, second] = [await run(), await run()];
  assert.equal(first.events[0].count, 1, "it did not arrive");
  assert.equal(first.state_hash, second.state_hash);
});
