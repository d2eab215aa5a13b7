// A run as an independent client sees it: @foxglove/ws-protocol for the protocol, @foxglove/rosmsg and rosmsg2-serialization for
// messages and services. What it decodes is held against the CSV that the run itself wrote.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { WebSocket } from "ws";
import { Scratch, Served, makeYard, readCsv, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const scratch = new Scratch();
const logFile = scratch.file("log.csv");
const beams = [0, 17, 90, 135, 180];
let served, viewer;
let messages = new Map();

before(async () => {
  served = await Served.start(["run", makeYard(scratch), "--log", logFile,
    "--log-values", ["rover.pose.x", "rover.pose.y", ...beams.map((i) => `rover/laser.ranges[${i}]`)].join(",")], scratch);
  viewer = new Viewer(served.ws, "foxglove.websocket.v1");
  await until("serverInfo", () => viewer.info);
});
after(async () => {
  viewer?.client.close();
  Served.killAll();
  scratch.remove();
});

test("both sub-protocols are spoken, and no other", async () => {
  assert.equal(viewer.socket.protocol, "foxglove.websocket.v1");
  const other = new Viewer(served.ws, "foxglove.sdk.v1");
  const info = await until("serverInfo", () => other.info);
  assert.equal(other.socket.protocol, "foxglove.sdk.v1");
  assert.equal(info.sessionId, viewer.info.sessionId);
  other.client.close();
  for (const capability of ["clientPublish", "time", "parameters", "parametersSubscribe", "services", "connectionGraph", "assets"])
    assert.ok(viewer.info.capabilities.includes(capability), capability);
  assert.equal(viewer.info.metadata.ROS_DISTRO, "humble");
  const wrong = new WebSocket(served.ws, ["chat"]);
  const refused = await new Promise((done) => { wrong.on("error", done); wrong.on("open", () => done(undefined)); });
  assert.ok(refused, "an unknown sub-protocol");
});

test("scans and transforms are those of the run", async () => {
  const scans = [], poses = [];
  const frame = (t) => t.header.frame_id === "world" && t.child_frame_id.startsWith("rover/");
  const a = await viewer.subscribe("/rover/laser/ranges", (scan, time) => scans.push({ scan, time }));
  const b = await viewer.subscribe("/tf", (tf) => tf.transforms.filter(frame).forEach((t) => poses.push(t)));
  await until("20 scans and 20 transforms", () => scans.length >= 20 && poses.length >= 20);
  viewer.client.unsubscribe(a);
  viewer.client.unsubscribe(b);
  messages.set("scans", scans).set("poses", poses);
  for (const { scan, time } of scans)
    assert.equal(BigInt(scan.header.stamp.sec) * 1000000000n + BigInt(scan.header.stamp.nsec), time);
  assert.ok(viewer.times.length > 0, "time");
});

test("a parameter is read, set, and refused when it makes no sense", async () => {
  const name = "rover/laser.noise.white";
  viewer.client.getParameters([name], "1");
  const old = await until("the value", () => viewer.parameters.get(name));
  assert.equal(typeof old, "number");
  viewer.client.setParameters([{ name, value: 0.25 }], "2");
  await until("the new value", () => viewer.parameters.get(name) === 0.25);
  const shown = await viewer.call("/sandlot/console", { line: `show ${name}` });
  assert.equal(shown.ok, true);
  assert.match(shown.text, /0\.25/);
  viewer.statuses.length = 0;
  viewer.client.setParameters([{ name, value: -1 }], "3");
  await until("a reason", () => viewer.statuses.some((s) => s.level > 0));
  viewer.client.setParameters([{ name, value: old }], "4");
  await until("the old value", () => viewer.parameters.get(name) === old);
});

test("services answer", async () => {
  const state = await viewer.call("/get_simulation_state", {});
  assert.equal(state.state.state, 1, "simulation_interfaces/SimulationState: STATE_PLAYING is 1");
  const wrong = await viewer.call("/sandlot/console", { line: "lsit" });
  assert.equal(wrong.ok, false);
  assert.match(wrong.text, /list/);
});

test("publishing drives a robot", async () => {
  let x;
  await viewer.subscribe("/tf", (tf) => tf.transforms.forEach((t) => {
    if (t.header.frame_id === "world" && t.child_frame_id.startsWith("idle/")) x = t.transform.translation.x;
  }));
  const begin = await until("its place", () => x);
  assert.equal(begin, 0, "it stands where the scenario put it");
  const id = viewer.client.advertise({ topic: "/idle/cmd_vel", encoding: "json", schemaName: "geometry_msgs/msg/Twist" });
  viewer.client.sendMessage(id, new TextEncoder().encode(JSON.stringify({ linear: { x: 0.4, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0 } })));
  // East of it, 3 m on, is a wall: it gets somewhere.
  await until("half a metre", () => x > 0.5);
});

test("what is drawn comes as assets, and nothing else does", async () => {
  let world;
  await viewer.subscribe("/sandlot/world", (w) => { world = w; });
  await until("the world", () => world);
  const shapes = world.models.flatMap((m) => m.links.flatMap((l) => l.visuals.map((v) => v.shape)));
  const mesh = shapes.find((s) => s.type === "mesh");
  assert.ok(mesh, "the rock is a mesh");
  viewer.client.fetchAsset(`sandlot://mesh/${mesh.mesh}`, 1);
  viewer.client.fetchAsset("file:///etc/passwd", 2);
  const rock = await until("the rock", () => viewer.assets.get(1));
  const view = rock.data;
  assert.equal(view.getUint32(0, true), 0x314d4c53);
  assert.equal(view.getUint32(8, true), 4, "a tetrahedron has four faces");
  const other = await until("an answer", () => viewer.assets.get(2));
  assert.equal(other.status, 1);
  const page = await fetch(`${new URL(served.url).origin}/assets/mesh/${mesh.mesh}`);
  assert.deepEqual(Buffer.from(await page.arrayBuffer()), Buffer.from(view.buffer, view.byteOffset, view.byteLength));
});

test("the graph tells who says what", async () => {
  viewer.client.subscribeConnectionGraph();
  const who = await until("the graph", () => viewer.published.get("/rover/laser/ranges"));
  assert.ok(who.length > 0);
});

test("the run ends cleanly, and its own log says the same numbers", async () => {
  viewer.client.close();
  assert.equal(await served.stop(), 0, served.error);
  assert.ok(served.summary.server.viewers_most >= 1);
  const log = readCsv(logFile);
  let compared = 0;
  for (const { scan, time } of messages.get("scans")) {
    const row = log.rows.get((Number(time) * 1e-9).toFixed(3));
    if (!row) continue;  // beyond the last line
    beams.forEach((beam, i) => assert.equal(scan.ranges[beam], Math.fround(row[3 + i]), `beam ${beam} at ${time}`));
    ++compared;
  }
  for (const t of messages.get("poses")) {
    const row = log.rows.get((t.header.stamp.sec + t.header.stamp.nsec * 1e-9).toFixed(3));
    if (!row) continue;
    assert.ok(Math.abs(t.transform.translation.x - row[1]) < 1e-12 && Math.abs(t.transform.translation.y - row[2]) < 1e-12);
    ++compared;
  }
  assert.ok(compared >= 35, `${compared} compared`);
});
