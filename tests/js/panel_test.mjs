// Screens, keys and speakers of robots on the page, in a browser as a person uses it. What it should have done is asked of the run itself, over
// a connection of its own. Pictures stay in BUILD/page_tests.
import assert from "node:assert/strict";
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { Scratch, Served, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const pictures = `${process.env.SANDLOT_BUILD ?? "build/release"}/page_tests`;
mkdirSync(pictures, { recursive: true });
const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
const skip = existsSync(executablePath) ? false : "there is no chromium";
const scratch = new Scratch();
const [width, height] = [96, 64];
let browser, served, page, probe;
const complaints = [];
const heard = { keys: null, sound: null, text: null };

const by = (id) => `[data-testid="${id}"]`;
const inspector = by("inspector");
const picture = (of, name) => of.screenshot({ path: `${pictures}/${name}.png` });
/** What the canvas shows at a pixel: [red, green, blue]. */
const pixel = (where, x, y) => page.locator(`${where} ${by("lcd")}`).evaluate((canvas, [px, py]) =>
  [...canvas.getContext("2d").getImageData(px, py, 1, 1).data.slice(0, 3)], [x, y]);

function makeWorld() {
  scratch.write("hall.sdf", `<?xml version="1.0"?><sdf version="1.9"><world name="hall">
    <light name="sun" type="directional"><direction>-0.4 0.3 -0.9</direction></light>
    <model name="wall"><static>true</static><pose>1.5 0 0.25 0 0 0</pose><link name="link">
      <collision name="c"><geometry><box><size>0.1 4 0.5</size></box></geometry></collision>
      <visual name="v"><geometry><box><size>0.1 4 0.5</size></box></geometry></visual></link></model>
    </world></sdf>`);
  const rover = join(process.cwd(), "models/rover/model.sdf");
  return scratch.write("panels.yaml", `version: 1
name: panels
world: hall.sdf
physics: planar
time: {step: 10 ms}
robots:
  - name: rover
    model: ${rover}
    devices:
      lcd: {kind: screen, width: ${width}, height: ${height}, background: [0, 0, 0.4]}
      keys: {kind: keys}
      speaker: {kind: speaker}
      front: {kind: range_finder, rings: 0, max_range: 4, pose: [0.2, 0, 0.15, 0, 0, 0]}
      left: {kind: range_finder, rings: 0, max_range: 4, pose: [0.1, 0.15, 0.15, 0, 0, 0.6]}
      right: {kind: range_finder, rings: 0, max_range: 4, pose: [0.1, -0.15, 0.15, 0, 0, -0.6]}
  - name: other
    model: ${rover}
    pose: [0, 1, 0]
    devices:
      lcd: {kind: screen}
      keys: {kind: keys, count: 2}
`);
}

before(async () => {
  if (skip) return;
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  served = await Served.start(["run", makeWorld()], scratch);
  probe = new Viewer(served.ws, "foxglove.websocket.v1");
  await probe.subscribe("/rover/keys/presses", (m) => { heard.keys = m; });
  await probe.subscribe("/rover/speaker/sound", (m) => { heard.sound = m; });
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 } });
  page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await page.goto(served.url);
  await page.locator(`${by("tree")} [data-address="rover"]`).click();
});
after(async () => {
  probe?.close();
  await browser?.close();
  await served?.stop();
  Served.killAll();
  scratch.remove();
});

test("a key pressed on the page arrives in the topic of the robot", { skip }, async () => {
  await page.locator(`${inspector} ${by("key-3")}`).click();
  await until("a press", () => heard.keys);
  assert.equal(Number(heard.keys.count), 1);
  assert.deepEqual(heard.keys.latest.map((p) => [p.key, p.x, p.y]), [[3, 0, 0]]);
  assert.equal(await page.locator(`${inspector} .lcd-key`).count(), 4);
});

test("the screen shows the robot's pixels and labels", { skip }, async () => {
  // Two letters of 3 x 5 squares of four pixels and a bar, on the background 0, 0, 0.4 * 255 = 102.
  const letters = ["101 111", "101 010", "111 010", "101 010", "101 111"].map((row) => row.replace(" ", "0"));
  const cell = 4, columns = 7;
  const data = [];
  for (let y = 0; y < 5 * cell; ++y) for (let x = 0; x < columns * cell; ++x) data.push(...(letters[Math.floor(y / cell)][Math.floor(x / cell)] === "1" ? [255, 220, 40] : [0, 0, 102]));
  const bar = Array.from({ length: 80 * 6 }, (_, i) => [255 - (i % 80) * 3, (i % 80) * 3, 30]).flat();
  const patches = probe.client.advertise({ topic: "/rover/lcd/pixels/command", encoding: "json", schemaName: "sandlot_msgs/msg/ScreenPatch" });
  for (const patch of [{ x: 8, y: 10, width: columns * cell, height: 5 * cell, data }, { x: 8, y: 50, width: 80, height: 6, data: bar },
    { has_text: true, lines: ["HI", "", "ready"], menu: ["GO", "STOP", "", "END"] }]) {
    probe.client.sendMessage(patches, new TextEncoder().encode(JSON.stringify(patch)));
  }
  await page.locator(`${inspector} ${by("lcd")}`).waitFor();
  await until("the pixels", async () => (await pixel(inspector, 8, 10))[0] === 255);
  assert.deepEqual(await pixel(inspector, 8, 10), [255, 220, 40]);
  assert.deepEqual(await pixel(inspector, 12, 10), [0, 0, 102], "between the strokes of the H");
  assert.deepEqual(await pixel(inspector, 7, 10), [0, 0, 102], "the background");
  assert.deepEqual(await pixel(inspector, 87, 55), [255 - 79 * 3, 79 * 3, 30], "the last pixel of the bar");
  const key = (i) => page.locator(`${inspector} ${by(`key-${i}`)}`);
  await until("the labels", async () => (await key(1).textContent()) === "GO");
  assert.equal(await key(4).textContent(), "END");
  assert.equal(await page.locator(`${inspector} ${by("lcd-text")}`).textContent(), "HI\n\nready");
});

test("a click on the screen is a touch at its pixel", { skip }, async () => {
  const canvas = page.locator(`${inspector} ${by("lcd")}`);
  const box = await canvas.boundingBox();
  // The middle of pixel (60, 20).
  await canvas.click({ position: { x: ((60 + 0.5) / width) * box.width, y: ((20 + 0.5) / height) * box.height } });
  await until("the touch", () => Number(heard.keys.count) === 2);
  assert.deepEqual(heard.keys.latest.map((p) => [p.key, p.x, p.y])[1], [0, 60, 20]);
});

test("the speaker's sign shows while it plays", { skip }, async () => {
  const sign = page.locator(`${inspector} ${by("sound")}`);
  assert.equal(await sign.isVisible(), false);
  await probe.say('command rover/speaker Sound {"frequency": 440, "duration": 4}');
  await sign.waitFor({ state: "visible" });
  assert.equal(await sign.textContent(), "440 Hz");
  await picture(page, "robot_panel");
  await sign.waitFor({ state: "hidden" });
  assert.equal(heard.sound.playing, false);
});

test("the tab Panels shows every robot's", { skip }, async () => {
  await page.getByRole("tab", { name: "Panels" }).click();
  await page.locator(`${by("panel-other")} .lcd-key`).first().waitFor();
  await until("two keys", async () => (await page.locator(`.robot-panels ${by("panel-other")} .lcd-key`).count()) === 2);
  const where = `.robot-panels ${by("panel-rover")}`;
  await until("the pixels", async () => (await pixel(where, 8, 10))[0] === 255);
  await picture(page, "robot_panels");
  await page.locator(`${where} ${by("key-1")}`).click();
  await until("the press", () => Number(heard.keys.count) === 3);
});

test("nothing went wrong in the browser", { skip }, () => assert.deepEqual(complaints, []));

test("a spectator sees the screen and presses nothing", { skip }, async () => {
  // Two pages that draw with the processor would hinder each other.
  await page.context().close();
  const url = new URL(served.url);
  url.searchParams.set("role", "spectator");
  const other = await (await browser.newContext({ viewport: { width: 1280, height: 860 } })).newPage();
  other.setDefaultTimeout(60000);
  await other.goto(url.href);
  await other.locator(`${by("tree")} [data-address="rover"]`).click();
  await other.locator(`${inspector} ${by("lcd")}`).waitFor();
  assert.equal(await other.locator(`${inspector} ${by("key-1")}`).isDisabled(), true);
  await other.locator(`${inspector} ${by("lcd")}`).click();
  await new Promise((done) => setTimeout(done, 300));
  assert.equal(Number(heard.keys.count), 3);
  await other.context().close();
});
