// Clients in JavaScript against runs of the built command: by lines over TCP, as node does, and by WebSocket, as browsers do.
// The examples in examples/clients end where they are meant to, and give the run of their twins in Python to the last bit.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { chmodSync, cpSync, existsSync, mkdirSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { basename, join } from "node:path";
import { after, before, test } from "node:test";
import ws from "ws";
import { IntervalTimer } from "../../clients/javascript/clock.mjs";
import * as client from "../../clients/javascript/sandlot_client.mjs";
import { Connection, Disconnected, Refused, Robot, RunEnded, Step, dataOf, numbers, packet } from "../../clients/javascript/sandlot_client.mjs";
import { Scratch, Served, until } from "./served.mjs";

const scratch = new Scratch();
const examples = scratch.file("examples");
const wander = "examples/clients/wander.yaml";

before(() => {  // as `npm install --no-save clients/javascript` leaves it
  cpSync("examples/clients", examples, { recursive: true, filter: (file) => !file.endsWith("node_modules") });
  mkdirSync(join(examples, "node_modules"));
  symlinkSync(join(process.cwd(), "clients/javascript"), join(examples, "node_modules/sandlot_client"));
});
after(() => {
  Served.killAll();
  scratch.remove();
});

const start = (file, ...more) => Served.start(["run", file, "--rate", "max", ...more], scratch);
const tcp = (served) => served.url.replace("http:", "tcp:");

/** Runs a program against a run. @return promise of its exit code and output */
function program(served, command, ...args) {
  const child = spawn(command, args, { env: { ...process.env, SANDLOT_URL: tcp(served), PYTHONPATH: "clients/python" } });
  let out = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (data) => { out += data; });
  return new Promise((done) => child.on("close", (code) => done({ code, out })));
}

// Python's sum() makes up for rounding errors from 3.12 on. Here that of every Python does, so that no example rests on either.
const summing = `
import builtins, math, runpy, sys
plain = sum
def summed(values, start=0):
    values = [start, *values]
    return math.fsum(values) if any(isinstance(each, float) for each in values) else plain(values[1:], start)
builtins.sum = summed
del sys.argv[0]
runpy.run_path(sys.argv[0], run_name="__main__")
`;

/** Runs an example to its end. @return the summary */
async function runExample(name, language, roles, more = []) {
  const served = await start(`examples/clients/${name}.yaml`, ...more);
  const [command, suffix] = language === "js" ? [[process.execPath], "mjs"] : [["python3", "-c", summing], "py"];
  const programs = roles.map((role) => program(served, ...command, join(examples, `${name}.${suffix}`), ...role));
  assert.equal(await served.ended, 0, served.error);
  for (const each of programs) assert.deepEqual(await each, { code: 0, out: "" });
  return served.summary;
}

const outcomes = {
  wander: { roles: [[]], more: ["--duration", "12s"], holds: (s) => assert.ok(s.robots[0].distance_m > 2 && s.robots[0].covered_m2 > 1) },
  follow_ball: { roles: [[]], holds: (s) => assert.deepEqual(s.events.map((e) => e.count > 0), [true, true]) },
  radio_pair: { roles: [["red"], ["blue"]], holds: (s) => {
    assert.equal(s.events[0].count, 1);
    assert.ok(Math.abs(s.robots[0].pose[0] - s.robots[1].pose[0]) < 0.03);
  } },
  team: { roles: [[]], holds: (s) => assert.equal(s.events[0].count, 1) },
};
for (const [name, { roles, more, holds }] of Object.entries(outcomes))
  test(`the example ${name} does its task, twice alike and as in Python`, async () => {
    const first = await runExample(name, "js", roles, more);
    holds(first);
    const second = await runExample(name, "js", [...roles].reverse(), more);
    assert.equal(second.state_hash, first.state_hash);
    const python = await runExample(name, "python", roles, more);
    assert.equal(python.state_hash, first.state_hash);
  });

// Without the administrator's token, which is part of the address that a run with tokens prints.
const plain = (url) => url.replace(/\?.*/, "");
test("the program of the docs drives a robot", async () => {
  const page = readFileSync("docs/clients.md", "utf8");
  const file = join(examples, "docs.mjs");
  writeFileSync(file, /```js\n(.*?)```/s.exec(page)[1]);
  const [run, ...args] = /```sh\nsandlot (run .*?)\n/.exec(page)[1].replace(" --port 8765", "").split(" ");
  const served = await Served.start([run, ...args, "--duration", "5s", "--rate", "max"], scratch);
  const done = program(served, process.execPath, file);
  assert.equal(await served.ended, 0, served.error);
  assert.deepEqual(await done, { code: 0, out: "" });
  assert.ok(served.summary.robots[0].distance_m > 0.5);
});

const chromium = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
test("in a browser the library drives a robot, to the same run as in node", { skip: existsSync(chromium) ? false : "there is no chromium" }, async () => {
  const law = `async (Robot, options) => {
    const rover = await Robot.connect("rover", { ...options, lockstep: true, deadline_s: 5 });
    const laser = rover.subscribe("laser");
    for await (const step of rover.steps())
      rover.command("drive", { linear: { x: 0.3 + 0.1 * step.uniform() }, angular: { z: laser.message.ranges[0] ?? 0 } });
    return rover.lost.name;
  }`;
  const pages = createServer((request, response) => {
    const file = request.url.slice(1);
    response.setHeader("Content-Type", file.endsWith(".mjs") ? "text/javascript" : "text/html");
    response.end(file.endsWith(".mjs") ? readFileSync(join("clients/javascript", basename(file))) : "<!doctype html><title>a page</title>");
  });
  await new Promise((done) => pages.listen(0, "127.0.0.1", done));
  const origin = `http://127.0.0.1:${pages.address().port}`;
  const browser = await (await import("playwright-core")).chromium.launch({ executablePath: chromium, args: ["--no-sandbox", "--disable-gpu"] });
  try {
    const page = await browser.newPage();
    await page.goto(origin);
    const served = await start(wander, "--duration", "2s", "--allow-origin", origin);
    const ended = page.evaluate(`import("/sandlot_client.mjs").then(({ Robot }) => (${law})(Robot, { url: "${served.ws}" }))`);
    assert.equal(await served.ended, 0, served.error);
    assert.equal(await ended, "RunEnded");
    const inBrowser = served.summary.state_hash;
    const again = await start(wander, "--duration", "2s");
    await eval(law)(Robot, { url: tcp(again) });
    await again.ended;
    assert.equal(again.summary.state_hash, inBrowser);
    const closed = await start(wander, "--duration", "2s");
    await assert.rejects(page.evaluate(`import("/sandlot_client.mjs").then(({ Robot }) => Robot.connect("rover", { url: "${closed.ws}", timeout_s: 0.2 }))`),
      new RegExp(`no run answers at ws:.*: start one with --port and --allow-origin ${origin}`));
    closed.process.kill("SIGKILL");
  } finally {
    await browser.close();
    pages.close();
  }
});

const ways = { "lines over TCP": (served) => ({ url: plain(tcp(served)) }), "WebSocket": (served) => ({ url: plain(served.ws), WebSocket: ws }) };
for (const [way, options] of Object.entries(ways)) {
  test(`a robot in lockstep by ${way}: every step in order, fresh readings, and a clean end`, async () => {
    const served = await start(wander, "--duration", "2s");
    const rover = await Robot.connect("rover", { ...options(served), lockstep: true });
    const odometry = rover.subscribe("drive");
    const steps = [], drawn = [];
    for await (const step of rover.steps()) {
      steps.push([step.number, step.time_s, odometry.fresh()]);
      drawn.push(step.uniform());
      rover.command("drive", { linear: { x: 0.2 } });
    }
    assert.equal(await served.ended, 0);
    // 2 s at 0.1 s are 20 steps, and the one of the tick with which the run ends.
    assert.deepEqual(steps.slice(0, 20), Array.from({ length: 20 }, (_, i) => [i, i / 10, true]));
    assert.equal(rover.period_s, 0.1);
    assert.ok(rover.lost instanceof RunEnded);
    assert.ok(drawn.every((each) => each >= 0 && each < 1));
    assert.equal(new Set(drawn).size, drawn.length);
    assert.throws(() => rover.command("drive", {}), RunEnded);
    assert.equal(await rover.spin(1), false);
    // v = 0.2 m/s from the second tick on, less the way lost to an acceleration of 1 m/s^2: 0.2 * 1.98 - 0.2^2 / 2.
    assert.ok(Math.abs(served.summary.robots[0].distance_m - 0.376) < 0.01, `${served.summary.robots[0].distance_m}`);
  });

  test(`refusals by ${way} carry the server's words`, async () => {
    const tokens = scratch.write("tokens.yaml", "- {token: sesame-one, robot: rover}\n- {token: sesame-all, role: admin}\n");
    chmodSync(tokens, 0o600);
    const served = await Served.start(["run", wander, "--duration", "20s", "--tokens", tokens], scratch);
    await assert.rejects(Robot.connect("rover", options(served)), (e) => e instanceof Refused && /this is not the token of 'rover'/.test(e.message));
    const rover = await Robot.connect("rover", { ...options(served), token: "sesame-one" });
    assert.throws(() => rover.subscribe("lasr"), /'rover\/lasr' publishes nothing; there are: .*\/rover\/laser\/ranges/);
    await assert.rejects(rover.call("/delete_entity", { entity: "rover" }), Refused);
    const said = new Promise((done) => { rover.onStatus = done; });
    rover.publish("/rover/drive", { linaer: { x: 1 } });
    assert.match((await said).msg, /linaer/);
    const other = await Robot.connect("rover", { ...options(served), token: "sesame-one" });
    await assert.rejects(async () => { for (;;) await rover.spin(0.01); },
      (e) => e instanceof Disconnected && !(e instanceof RunEnded) && /another client has taken over/.test(e.message));
    other.close();
    // The administrator's token is in the address that the run prints.
    const claim = () => Robot.connect("rover", { ...options(served), url: served.url }).then((robot) => { robot.close(); return true; }, () => false);
    await until("the robot that was let go", claim);
    assert.throws(() => other.send({ op: "x" }), /was closed/);
    await served.stop();
  });
}

test("services of devices: a free client waits for the answer, one in lockstep has it in a later step", async () => {
  const scenario = scratch.write("odometry.yaml", `version: 1
physics: planar
time: {step: 20 ms, control_interval: 5, stop: 2 s}
robots:
  - name: rover
    model: ${join(process.cwd(), "models/rover/model.sdf")}
    controller: {kind: remote, deadline: 5 s}
    devices: {odometry: {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint, wheel_radius: 5 cm, wheel_separation: 23 cm}}
  - {name: free, model: ${join(process.cwd(), "models/rover/model.sdf")}, pose: [0, 2, 0],
     devices: {odometry: {kind: wheel_odometry, left_joint: left_wheel_joint, right_joint: right_wheel_joint, wheel_radius: 5 cm, wheel_separation: 23 cm}}}
`);
  const served = await start(scenario);
  const rover = await Robot.connect("rover", { url: tcp(served), lockstep: true, deadline_s: 5 });
  const free = await Robot.connect("free", { url: tcp(served) });
  const odometry = rover.subscribe("odometry");
  const x = [];
  let answer, answered, freed;
  for await (const step of rover.steps()) {
    x.push(odometry.value("pose.pose.position.x"));
    rover.command("drive", { linear: { x: 0.5 } });
    if (step.number === 9) answer = rover.call("odometry/reset");
    if (step.number === 9) freed = free.call("odometry/reset");
    if (step.number === 10) answered = [await answer, await freed];
  }
  assert.deepEqual(answered.map((each) => each.success), [true, true]);
  assert.ok(x[9] > 0.3 && x[10] < 0.1 && x[15] > 0.2, `${x}`);
  await served.ended;
});

test("a loop that is left ends its step", async () => {
  const served = await start(wander, "--duration", "1s");
  const rover = await Robot.connect("rover", { url: tcp(served), lockstep: true, deadline_s: 60 });
  for await (const step of rover.steps()) {
    rover.command("drive", { linear: { x: 0.4 } });
    if (step.number === 2) break;
  }
  const rest = [];
  for await (const step of rover.steps()) rest.push(step.number);
  assert.equal(rest[0], 3);
  assert.equal(await served.ended, 0);
});

test("a free client has a clock of simulated time", async (t) => {
  const served = await Served.start(["run", wander, "--set", "robots.rover.controller=null", "--duration", "3s", "--rate", "2"], scratch);
  const rover = await Robot.connect("rover", { url: tcp(served) });
  if (!("/sandlot/step_times" in await rover.topics())) return t.skip("this server sends no step times");
  const begun = performance.now();
  assert.equal(await rover.clock.sleepUntil(2.5, 20), true);
  assert.ok(performance.now() - begun < 2500, "at twice real time");
  assert.ok(rover.clock.messages > 10);
  assert.ok(Math.abs(rover.clock.nowS() - 2.5) < 0.2, `${rover.clock.nowS()}`);
  await served.ended;
});

test("addresses: what is wrong with one, and a run that does not answer", async () => {
  await assert.rejects(Connection.connect({ url: "127.0.0.1:8765" }), /is not an address/);
  await assert.rejects(Connection.connect({ url: "wss://127.0.0.1:1", WebSocket: undefined }), globalThis.WebSocket ? /no run answers/ : /needs the option WebSocket/);
  await assert.rejects(Connection.connect({ url: "tcp://127.0.0.1:1", timeout_s: 0.1 }), /no run answers at tcp:\/\/127.0.0.1:1: start one with --port/);
  await assert.rejects(Robot.connect("rover", { locstep: true }), /there is no option 'locstep'/);
});

test("the declarations for TypeScript name what the classes have", () => {
  const declared = readFileSync("clients/javascript/sandlot_client.d.mts", "utf8") + readFileSync("clients/javascript/clock.d.mts", "utf8");
  const classes = Object.entries({ ...client, IntervalTimer }).filter(([, each]) => typeof each === "function" && /^class/.test(String(each)));
  assert.ok(classes.length >= 8);
  for (const [name, each] of classes) {
    assert.match(declared, new RegExp(`(class|interface) ${name}\\b`));
    for (let proto = each.prototype; proto && proto !== Error.prototype && proto !== Object.prototype; proto = Object.getPrototypeOf(proto))
      for (const method of Object.getOwnPropertyNames(proto))
        if (method !== "constructor" && !method.startsWith("_")) assert.match(declared, new RegExp(`\\b${method}\\b`), `${name}.${method}`);
  }
});

test("words: random numbers, octets, numbers with gaps", () => {
  const step = (random) => new Step({ program: "a/b", step: 1, time: { sec: 1, nanosec: 500000000 }, random });
  assert.equal(step("0").uniform(), 0);
  assert.equal(step("2047").uniform(), 0);  // the eleven lowest bits do not count
  assert.equal(step("2048").uniform(), 2 ** -53);
  assert.equal(step("18446744073709551615").uniform(), 1 - 2 ** -53);
  assert.equal(step("9223372036854775808").uniform(), 0.5);
  // SplitMix64 from the seed 1234567: the first numbers of its reference implementation (prng.di.unimi.it/splitmix64.c).
  assert.deepEqual([1, 2, 3].map((i) => step("1234567").bits(i)), [6457827717110365317n, 3203168211198807973n, 9817491932198370423n]);
  assert.equal(step("5").time_s, 1.5);
  assert.deepEqual(packet("hé", "blue"), { to: "blue", data: "aMOp" });
  assert.deepEqual([...dataOf(packet(Uint8Array.of(0, 255, 128)))], [0, 255, 128]);
  assert.deepEqual([...numbers([1, null, 3], 8)], [1, 8, 3]);
});
