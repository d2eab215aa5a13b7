// The clock for clients in JavaScript against its twin in Python: the same messages at the same times give the same numbers to the last bit.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import { Clock } from "../../clients/javascript/clock.mjs";
import { Scratch } from "./served.mjs";

/** Numbers in [0, 1) that are the same in each run. */
function* draws() {
  for (let x = 12345; ;) yield (x = (x * 1103515245 + 12345) % 2147483648) / 2147483648;
}

/** Erratic steps of 10 ms: bursts, a pause, lost messages, a rewind. Entries: ["take", ...] or ["ask", wall, interval, target]. */
function makeTrace() {
  const random = draws(), next = () => random.next().value;
  const trace = [];
  let stamp = 0, wall = 100, slow = 1;
  for (let i = 0; i < 800; ++i) {
    if (next() < 0.02) slow = 0.3 + 4 * next();
    const restarted = i === 0 || i === 300;
    const count = 1 + Math.floor(3 * next());
    const walls = Array.from({ length: count - (restarted ? 1 : 0) }, () => 0.01 * slow * (0.5 + next()));
    if (i === 300) wall += 2;
    if (i === 500) stamp -= 1;
    if (i === 600) stamp += 0.5;
    stamp += 0.01 * count;
    wall += walls.reduce((a, b) => a + b, 0);
    trace.push(["take", stamp, 0.01, walls, wall + 0.003 * next(), restarted]);
    trace.push(["ask", wall + 0.02 * next(), next() < 0.5 ? 0 : next(), stamp + 0.3 * next() - 0.05]);
  }
  return trace;
}

const twin = `
import json, sys
from sandlot_client.clock import Clock
now = 0.0
clock = Clock(wall=lambda: now)
timer = clock.timer(0.07)
out = []
for entry in json.load(open(sys.argv[1])):
    if entry[0] == "take":
        now = entry[4]
        clock.take(*entry[1:])
    else:
        now = entry[1]
        out.append([clock.now_s(), clock.speed(entry[2]), clock.wall_s_until(entry[3]), timer.poll(), timer.next_s, timer.wall_s_left(), clock.rewinds])
print(json.dumps(out))
`;

test("the twins agree on time, speed, waiting and timers", () => {
  const scratch = new Scratch();
  try {
    const trace = makeTrace();
    const file = scratch.write("trace.json", JSON.stringify(trace));
    let now = 0;
    const clock = new Clock({ wall: () => now });
    const timer = clock.timer(0.07);
    const out = [];
    for (const [kind, ...entry] of trace)
      if (kind === "take") {
        now = entry[3];
        clock.take(...entry);
      } else {
        now = entry[0];
        out.push([clock.nowS(), clock.speed(entry[1]), clock.wallSUntil(entry[2]), timer.poll(), timer.nextS, timer.wallSLeft(), clock.rewinds]);
      }
    const expected = JSON.parse(execFileSync("python3", ["-c", twin, file], { env: { ...process.env, PYTHONPATH: "clients/python" } }));
    assert.deepEqual(out, expected);
    assert.equal(clock.rewinds, 1);
    assert.ok(new Set(out.map((each) => each[1])).size > 500, "the speed follows the steps");
  } finally {
    scratch.remove();
  }
});

test("waiting ends in simulated time, at a timeout, and when the run is rewound", async () => {
  let now = 0;
  const naps = [];
  const clock = new Clock({ wall: () => now, wait: async (s) => { naps.push(s); now += s; if (now < 0.35) feed(); } });
  let stamp = 0;
  // Twice real time: a step of 10 ms in 5 ms of wall time.
  function feed() {
    while (stamp < 2 * now - 0.01) clock.take(stamp += 0.01, 0.01, [0.005], stamp / 2);
  }
  clock.take(stamp = 0.01, 0.01, [], 0.005, true);
  const timer = clock.timer(0.1);
  assert.equal(await timer.wait(), 1);
  assert.ok(Math.abs(now - 0.055) < 0.006, `${now}`);  // 0.11 s of simulated time
  assert.equal(await timer.wait(0.001), 0);
  assert.equal(await clock.sleepUntil(0.5), true);
  assert.ok(Math.abs(now - 0.25) < 0.006, `${now}`);
  assert.equal(await clock.sleepUntil(5, 0.3), false);
  assert.ok(naps.every((s) => s <= 0.02));
  const rewound = clock.sleepUntil(50);
  clock.take(0.01, 0.01, [], now, true);
  assert.equal(await rewound, false);
  assert.throws(() => clock.timer(0), RangeError);
});
