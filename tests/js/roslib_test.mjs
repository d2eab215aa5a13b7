// A run as programs for ROS see it: roslib, as it comes from npm.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import ROSLIB from "roslib";
import { Scratch, Served, makeYard, until } from "./served.mjs";

const scratch = new Scratch();
let served, ros;

before(async () => {
  served = await Served.start(["run", makeYard(scratch)], scratch);
  ros = new ROSLIB.Ros({ url: served.ws });
  await new Promise((done, failed) => { ros.on("connection", done); ros.on("error", failed); });
});
after(() => {
  ros?.close();
  Served.killAll();
  scratch.remove();
});

const topic = (name, messageType, more = {}) => new ROSLIB.Topic({ ros, name, messageType, ...more });
const first = (of) => new Promise((done) => of.subscribe((message) => { of.unsubscribe(); done(message); }));

for (const compression of ["none", "png", "cbor"])
  test(`a scan comes with compression ${compression}`, async () => {
    const scan = await first(topic("/rover/laser/ranges", "sensor_msgs/LaserScan", { compression }));
    assert.equal(scan.ranges.length, 271);
    assert.equal(scan.header.frame_id, "rover/laser");
    if (compression === "cbor") assert.ok(scan.ranges instanceof Float32Array);
    assert.ok(scan.ranges.every((range) => range === null || range > 0));
  });

test("topics, types and services are found", async () => {
  const found = await new Promise((done, failed) => ros.getTopics(done, failed));
  const at = found.topics.indexOf("/rover/laser/ranges");
  assert.equal(found.types[at], "sensor_msgs/msg/LaserScan");
  assert.equal(await new Promise((done, failed) => ros.getTopicType("/clock", done, failed)), "rosgraph_msgs/msg/Clock");
  const services = await new Promise((done, failed) => ros.getServices(done, failed));
  assert.ok(services.includes("/get_entity_state"));
});

const state = (entity) => new Promise((done, failed) => new ROSLIB.Service({ ros, name: "/get_entity_state", serviceType: "simulation_interfaces/GetEntityState" })
  .callService(new ROSLIB.ServiceRequest({ entity }), done, failed));

test("a command drives a robot, and a service tells where it is", async () => {
  const drive = topic("/idle/cmd_vel", "geometry_msgs/Twist");
  const begin = (await state("idle")).state.pose.position;
  const timer = setInterval(() => drive.publish(new ROSLIB.Message({ linear: { x: 0.3 } })), 50);
  await until("a way of 10 cm", async () => {
    const now = (await state("idle")).state.pose.position;
    return Math.hypot(now.x - begin.x, now.y - begin.y) > 0.1;
  });
  clearInterval(timer);
});

test("what a service refuses comes back as its reason", async () => {
  const unknown = new ROSLIB.Service({ ros, name: "/get_entity_stat", serviceType: "x/Y" });
  const why = await new Promise((done) => unknown.callService(new ROSLIB.ServiceRequest({}), () => done("nothing"), done));
  assert.match(why, /did you mean '\/get_entity_state'/);
});
