// The page in a browser (Debian's Chromium, headless), as a person uses it. What it should have done is asked of the run itself, over a
// connection of its own or in the files that it writes. Pictures stay in BUILD/page_tests.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { chmodSync, existsSync, mkdirSync, readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { Scratch, Served, makeYard, readCsv, sandlot, until } from "./served.mjs";
import { TcpClient } from "./tcp_client.mjs";
import { Viewer } from "./viewer.mjs";

const pictures = `${process.env.SANDLOT_BUILD ?? "build/release"}/page_tests`;
mkdirSync(pictures, { recursive: true });
const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
const skip = existsSync(executablePath) ? false : "there is no chromium";
const scratch = new Scratch();
const logFile = scratch.file("log.csv");
let browser, served, page, probe, status;
const complaints = [];
let plotted;

const by = (id) => `[data-testid="${id}"]`;
const row = (address) => `${by("tree")} [data-address="${address}"]`;
const scene = "canvas" + by("scene");
const picture = (of, name) => of.screenshot({ path: `${pictures}/${name}.png` });

async function open(url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, acceptDownloads: true, ...options });
  const opened = await context.newPage();
  opened.setDefaultTimeout(60000);
  opened.on("pageerror", (error) => complaints.push(String(error)));
  opened.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await opened.goto(url);
  return opened;
}
/** A probe that always knows the latest status. */
async function watch(url) {
  const viewer = new Viewer(url, "foxglove.websocket.v1");
  await viewer.subscribe("/sandlot/status", (s) => { viewer.status = { ...s, count: (viewer.status?.count ?? 0) + 1 }; });
  await until("a status", () => viewer.status);
  return viewer;
}
/** The status after so many more of them: none of those is on its way any more. */
async function settled(viewer, more = 3) {
  const count = viewer.status.count;
  await until("further status messages", () => viewer.status.count >= count + more);
  return viewer.status;
}
const state = (viewer, wanted) => until(`state ${wanted}`, () => viewer.status.state === wanted);

before(async () => {
  if (skip) return;
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  served = await Served.start(["run", makeYard(scratch), "--log", logFile, "--log-values", "rover.pose.x,rover.pose.y"], scratch);
  probe = await watch(served.ws);
  page = await open(served.url);
});
after(async () => {
  probe?.close();
  await browser?.close();
  await served?.stop();
  Served.killAll();
  scratch.remove();
});

test("the page loads, and the robot moves", { skip }, async () => {
  await page.locator(row("rover")).click();
  const x = page.locator(`${by("inspector")} [data-address="rover.pose.x"]`);
  const first = await x.textContent();
  await until("another place", async () => (await x.textContent()) !== first);
  await page.locator(scene).first().waitFor();
  await picture(page, "page");
});

test("pause stops it, and a step is one tick", { skip }, async () => {
  await page.locator(by("play")).click();
  await state(probe, "paused");
  const { tick } = await settled(probe);
  assert.equal((await settled(probe)).tick, tick, "it stands still");
  await page.locator(by("step")).click();
  await until("a tick", () => probe.status.tick > tick);
  assert.equal((await settled(probe)).tick, tick + 1);
  assert.equal(probe.status.state, "paused");
});

test("two viewers see the same, and a spectator cannot steer", { skip }, async () => {
  const url = new URL(served.url);
  url.searchParams.set("role", "spectator");
  const other = await open(url.href);
  await other.locator(row("rover")).waitFor();
  const time = await page.locator(by("sim-time")).textContent();
  await until("the same time", async () => (await other.locator(by("sim-time")).textContent()) === time);
  await other.locator(by("role")).waitFor({ state: "visible" });
  const tick = probe.status.tick;
  await other.locator(by("play")).click({ force: true, timeout: 2000 }).catch(() => {});
  await other.keyboard.press("Space");
  assert.equal((await settled(probe)).tick, tick, "the page of a spectator does nothing");
  assert.equal(probe.status.state, "paused");
  await picture(other, "spectator");
  await other.context().close();
  // Nor does one who speaks the protocol.
  const spectator = new Viewer(`${served.ws}?role=spectator`, "foxglove.websocket.v1");
  await until("serverInfo", () => spectator.info);
  assert.equal(spectator.info.metadata.sandlot_role, "spectator");
  const answer = await spectator.say("run").catch((error) => ({ ok: false, text: String(error) }));
  assert.equal(answer.ok, false, answer.text);
  assert.equal((await settled(probe)).tick, tick);
  spectator.close();
});

test("dragging changes the pose", { skip }, async () => {
  await page.locator(by("play")).click();
  await state(probe, "playing");
  const before = [await probe.number("idle.pose.x"), await probe.number("idle.pose.y")];
  assert.deepEqual(before, [0, 1.5]);
  await page.locator(row("idle")).click();
  await page.locator(scene).hover();
  await page.keyboard.press("f");
  await page.locator(by("tool-move")).click();
  const box = await page.locator(scene).boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  // The camera flies to where `f` asked for: try until it has the robot in its middle.
  await until("another place", async () => {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + 60, middle[1] + 20, { steps: 4 });
    await page.mouse.move(middle[0] + 120, middle[1] + 40, { steps: 4 });
    await page.mouse.up();
    const now = [await probe.number("idle.pose.x"), await probe.number("idle.pose.y")];
    return Math.hypot(now[0] - before[0], now[1] - before[1]) > 0.1;
  });
  await picture(page, "dragged");
  await page.keyboard.press("v");
});

test("a parameter changed in a form changes the run, and is in the command log", { skip }, async () => {
  await page.locator(by("tree-filter")).fill("rover laser");
  await page.locator(row("rover/laser")).click();
  const field = page.locator(by("param-rover/laser.noise.white"));
  await field.fill("0.125");
  await field.press("Enter");
  probe.client.getParameters(["rover/laser.noise.white"], "form");
  await until("the new value", async () => {
    if (probe.parameters.get("rover/laser.noise.white") === 0.125) return true;
    probe.client.getParameters(["rover/laser.noise.white"], "form");
    return false;
  });
  await page.locator(by("tab-commands")).click();
  await page.locator(by("commands")).getByText(/noise.white = 0\.125/).first().waitFor();
  await picture(page, "commands");
  await page.locator(by("tree-filter")).fill("");
});

test("a plot draws the true values", { skip }, async () => {
  await page.locator(by("tab-plots")).click();
  await page.locator(by("plot-input")).first().fill("rover.pose.x");
  await page.locator(by("plot-input")).first().press("Enter");
  const begin = probe.status.tick;
  await until("a second", () => probe.status.tick > begin + 150);
  await picture(page, "plot");
  const [download] = await Promise.all([page.waitForEvent("download"), page.locator(by("plot-csv")).first().click()]);
  plotted = readFileSync(await download.path(), "utf8").trim().split("\n").map((line) => line.split(","));
  assert.ok(plotted.length > 20, `${plotted.length} lines`);
});

test("a robot is driven by keyboard", { skip }, async () => {
  await page.locator(row("idle")).click();
  const from = [await probe.number("idle.pose.x"), await probe.number("idle.pose.y")];
  await page.locator(by("drive")).click();
  await page.locator(scene).hover();
  await page.keyboard.down("w");
  await until("10 cm", async () =>
    Math.hypot(await probe.number("idle.pose.x") - from[0], await probe.number("idle.pose.y") - from[1]) > 0.1);
  await page.keyboard.up("w");
  await page.keyboard.press("Escape");
});

test("the console answers", { skip }, async () => {
  await page.locator(by("tab-console")).click();
  await page.locator(by("console-input")).fill("help");
  await page.locator(by("console-input")).press("Enter");
  await page.locator(by("console-output")).getByText(/pause/).first().waitFor();
  await picture(page, "console");
});

test("it fits a phone, and comes dark and light", { skip }, async () => {
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const first = await theme();
  await page.locator(by("theme")).click();
  await until("the other theme", async () => (await theme()) !== first);
  await picture(page, await theme());
  await page.setViewportSize({ width: 390, height: 800 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `${wide} px wide`);
  await page.locator(by("play")).waitFor({ state: "visible" });
  await picture(page, "phone");
  await page.setViewportSize({ width: 1280, height: 800 });
});

test("the run ends cleanly; its own log has the numbers of the plot; nothing went wrong in the page", { skip }, async () => {
  await page.context().close();
  probe.close();
  assert.equal(await served.stop(), 0, served.error);
  const log = readCsv(logFile);
  let compared = 0;
  for (const [time, x] of plotted.slice(1)) {
    const logged = log.rows.get(Number(time).toFixed(3));
    if (!logged || x === "") continue;
    assert.equal(Number(x), logged[1], `at ${time} s`);
    ++compared;
  }
  assert.ok(compared > 20, `${compared} compared`);
  assert.deepEqual(complaints, []);
});

test("a jump back leads to the same end", { skip }, async () => {
  const yard = [makeYard(scratch), "--duration", "3s"];
  const alone = JSON.parse(execFileSync(sandlot, ["run", ...yard, "--json"], { stdio: "pipe" })).state_hash;
  const run = await Served.start(["run", ...yard, "--paused"], scratch);
  const viewer = await watch(run.ws);
  const steered = await open(run.url);
  await steered.locator(by("play")).click();
  await until("two seconds", () => viewer.status.time_s > 2);
  await steered.locator(by("play")).click();
  await state(viewer, "paused");
  const { epoch } = viewer.status;
  const line = await steered.locator(by("timeline")).boundingBox();
  // The line goes from the beginning to the end at 3 s: a third of it is about 1 s.
  await steered.mouse.click(line.x + line.width / 3, line.y + line.height / 2);
  await until("another world", () => viewer.status.epoch > epoch && viewer.status.state === "paused" && viewer.status.time_s > 0);
  assert.ok(viewer.status.time_s > 0.8 && viewer.status.time_s < 1.2, `${viewer.status.time_s} s`);
  await picture(steered, "rewound");
  await steered.locator(by("reset")).click();
  await until("the beginning", () => viewer.status.time_s === 0);
  await steered.locator(by("play")).click();
  viewer.socket.on("close", () => {});
  assert.equal(await run.ended, 0, run.error);
  assert.equal(run.summary.state_hash, alone);
  await steered.context().close();
});

test("a recording plays with its timeline", { skip }, async () => {
  const file = scratch.file("r.mcap");
  execFileSync(sandlot, ["run", makeYard(scratch), "--duration", "2s", "--record", file], { stdio: "pipe" });
  const player = await Served.start(["replay", file], scratch);
  const viewer = await watch(player.ws);
  assert.equal(viewer.status.replay, true);
  assert.equal(viewer.status.end_s, 2);
  assert.equal((await settled(viewer)).time_s, 0, "it waits at its beginning");
  const shown = await open(player.url);
  await until("a timeline to click on", () => shown.locator(by("timeline")).evaluate((e) => !e.classList.contains("off")));
  // On a busy machine the page may still find its place when the first click comes: as a person would, click again.
  let clicked_ms = 0;
  await until("the middle", async () => {
    if (viewer.status.state === "paused" && viewer.status.time_s > 0.8 && viewer.status.time_s < 1.2) return true;
    if (Date.now() - clicked_ms < 4000) return false;
    clicked_ms = Date.now();
    const line = await shown.locator(by("timeline")).boundingBox();
    await shown.mouse.click(line.x + line.width / 2, line.y + line.height / 2);
    return false;
  });
  await picture(shown, "player");
  await shown.locator(by("play")).click();
  await until("its end", () => viewer.status.state === "ended");
  assert.equal(viewer.status.time_s, 2);
  viewer.close();
  await shown.context().close();
  assert.equal(await player.stop(), 0, player.error);
  assert.equal(player.summary.different_ticks, 0);
  assert.ok(player.summary.compared_ticks >= 200);
});

test("a field takes nothing before the value that holds has come", { skip }, async () => {
  const run = await Served.start(["run", makeYard(scratch)], scratch);
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  const held = [];
  let holding = true;
  await context.routeWebSocket(/.*/, (ws) => {
    const server = ws.connectToServer();
    server.onMessage((message) => {
      if (holding && typeof message === "string" && message.includes('"parameterValues"')) held.push(() => ws.send(message));
      else ws.send(message);
    });
  });
  const shown = await context.newPage();
  shown.setDefaultTimeout(60000);
  await shown.goto(run.url);
  await shown.locator(row("rover")).click();
  await shown.locator(by("tree-filter")).fill("rover laser");
  await shown.locator(row("rover/laser")).click();
  const field = shown.locator(by("param-rover/laser.noise.white"));
  await field.waitFor();
  await until("an answer that is held back", () => held.length > 0);
  assert.equal(await field.isDisabled(), true);
  assert.equal(await field.inputValue(), "");
  holding = false;
  for (const send of held) send();
  await until("a field to type in", () => field.isEnabled());
  assert.notEqual(await field.inputValue(), "");
  await field.fill("0.125");
  await field.press("Enter");
  const viewer = await watch(run.ws);
  await until("the new value", async () => {
    viewer.client.getParameters(["rover/laser.noise.white"], "form");
    return viewer.parameters.get("rover/laser.noise.white") === 0.125;
  });
  viewer.close();
  await context.close();
  assert.equal(await run.stop(), 0, run.error);
});

test("media, rules and programs of teams are listed with the world, with their parameters and values", { skip }, async () => {
  const yard = readFileSync(makeYard(scratch), "utf8").replace("name: idle,", "name: idle, team: red,");
  const file = scratch.write("parts.yaml", `${yard}teams:
  - {name: red, controller: {name: coach, kind: formation, odometry: truth}}
media:
  - {kind: wind, name: breeze, velocity: [0, 0, 0]}
  - {kind: shout, name: air}
rules:
  - {kind: impact, threshold: 0.001}
`);
  const run = await Served.start(["run", file], scratch);
  const viewer = await watch(run.ws);
  const shown = await open(run.url);
  const part = (path) => shown.locator(by(`part-${path}`));
  const inspector = shown.locator(by("inspector"));
  for (const path of ["media/breeze", "media/air", "rules/impact", "red/coach"]) await part(path).waitFor();
  await picture(shown, "world_parts");
  // A value that moves, and a parameter that is changed.
  await part("red/coach").click();
  const steps = inspector.locator('[data-address="red/coach.steps"]');
  const first = await steps.textContent();
  await until("another value", async () => (await steps.textContent()) !== first);
  await picture(shown, "team_program");
  for (const [path, parameter, value] of [["media/air", "media/air.threshold", 42], ["red/coach", "red/coach.spacing", 1.5],
    ["rules/impact", "rules/impact.threshold", 0.25]]) {
    await inspector.locator(".crumb").click();
    await part(path).click();
    const field = shown.locator(by(`param-${parameter}`));
    await field.fill(String(value));
    await field.press("Enter");
    await until(`${parameter} = ${value}`, async () => {
      viewer.client.getParameters([parameter], "parts");
      return viewer.parameters.get(parameter) === value;
    });
  }
  await inspector.locator(".crumb").click();
  await part("media/air").click();
  await inspector.locator('[data-address="media/air.words"]').waitFor();
  await picture(shown, "medium");
  // The program of its team is listed with a robot, too.
  await shown.locator(row("idle")).click();
  await part("red/coach").click();
  await inspector.getByText("Drives the robots of a team").waitFor();
  await shown.context().close();
  viewer.close();
  assert.equal(await run.stop(), 0, run.error);
});

test("what a camera sees is shown in a pane, its view and what it finds in the scene", { skip }, async () => {
  const yard = makeYard(scratch);
  const model = scratch.write("eye.sdf", `<?xml version="1.0"?><sdf version="1.9" xmlns:sandlot="urn:sandlot:sdf"><model name="eye"><link name="body">
    <visual name="v"><geometry><box><size>0.1 0.1 0.1</size></box></geometry></visual>
    <collision name="c"><geometry><box><size>0.1 0.1 0.1</size></box></geometry></collision>
    </link>
    <sandlot:device name="camera" kind="camera" link="body"><pose>0 0 0.3 0 0 0</pose><width>160</width><height>120</height><rate>10</rate>
    </sandlot:device></model></sdf>`);
  const file = scratch.write("eyes.yaml", `${readFileSync(yard, "utf8")}  - {name: watcher, model: ${model}, pose: [-2.4, -0.6, 0.05, 0, 0, 0.6]}\n`);
  const run = await Served.start(["run", file], scratch);
  const viewer = await watch(run.ws);
  const shown = await open(run.url);
  await shown.locator(by("tab-pictures")).click();
  const canvas = shown.locator(by("picture")).first();
  await canvas.waitFor({ state: "visible" });
  const colours = () => canvas.evaluate((c) => {
    const { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add(data[i] >> 4 << 8 | data[i + 1] >> 4 << 4 | data[i + 2] >> 4);
    return { size: `${c.width}x${c.height}`, count: seen.size };
  });
  const first = await colours();
  assert.equal(first.size, "160x120");
  assert.ok(first.count > 5, `walls, ground and a rover: ${first.count} colours`);
  // A second pane, and one less again.
  await shown.locator(by("add-picture")).click();
  assert.equal(await shown.locator(by("picture-topic")).count(), 2);
  await shown.locator(by("close-picture")).last().click();
  assert.equal(await shown.locator(by("picture-topic")).count(), 1);
  // The pyramid has the width that the camera says: 60 degrees, at 1 m 2 tan(30 deg) = 1.155 m wide, 0.866 m high.
  await shown.locator(by("overlays")).click();
  await shown.getByText("Camera views").click();
  await shown.keyboard.press("Escape");
  const pyramids = () => shown.evaluate(() => {
    const { pyramids } = window.sandlot.scene.marks;
    const m = pyramids.matrices;
    return { count: pyramids.mesh.count, wide: Math.hypot(m[4], m[5], m[6]), high: Math.hypot(m[8], m[9], m[10]) };
  });
  await until("the camera's view", async () => (await pyramids()).count === 1);
  const view = await pyramids();
  assert.ok(Math.abs(view.wide - 1.1547) < 0.01 && Math.abs(view.high - 0.866) < 0.01, JSON.stringify(view));
  await picture(shown, "pictures");
  // Another level, from the page and from the console: what is found is drawn where the things are.
  await shown.locator(by("tree-filter")).fill("watcher camera");
  await shown.locator(row("watcher/camera")).click();
  await shown.locator(by("level-objects")).click();
  const diamonds = () => shown.evaluate(() => {
    const { diamonds } = window.sandlot.scene.marks;
    return Array.from({ length: diamonds.mesh.count }, (_, i) => [diamonds.matrices[16 * i + 12], diamonds.matrices[16 * i + 13]]);
  });
  await until("an object", async () => (await diamonds()).length > 0);
  const answer = await viewer.say("level watcher/camera objects");
  assert.equal(answer.ok, true, answer.text);
  await until("the idle rover among them", async () => (await diamonds()).some(([x, y]) => Math.hypot(x - 0, y - 1.5) < 0.2));
  await picture(shown, "objects");
  await shown.context().close();
  viewer.close();
  assert.equal(await run.stop(), 0, run.error);
});

test("who hears whom, how full batteries are and how teams stand is seen in the scene, and can be switched off", { skip }, async () => {
  const words = Array.from({ length: 200 }, (_, i) => `{at: ${(i + 1) / 10} s, orders: {radio: hello}}`).join(", ");
  const devices = (capacity) => `devices: {radio: {kind: radio}, battery: {kind: battery, capacity: ${capacity}, drain: 1 W}}`;
  const yard = readFileSync(makeYard(scratch, { controller: `{kind: sequence, steps: [${words}]}` }), "utf8")
    .replace("name: rover,", `name: rover, team: red, ${devices("10 kJ")},`).replace("name: idle,", `name: idle, team: blue, ${devices("1 J")},`);
  const file = scratch.write("team.yaml", `${yard}media:
  - {kind: radio}
teams:
  - {name: red, criterion: "2 + (sim.time > 1.5)"}
  - {name: blue, criterion: "idle/battery.fraction * 0"}
criterion: sim.time
`);
  const alone = JSON.parse(execFileSync(sandlot, ["run", file, "--duration", "3s", "--json"], { stdio: "pipe" })).state_hash;
  const recording = scratch.file("team.mcap");
  const run = await Served.start(["run", file, "--duration", "3s", "--paused", "--record", recording], scratch);
  const shown = await open(run.url);
  const drawn = (on) => on.evaluate(() => ({ links: window.sandlot.scene.links.count, batteries: window.sandlot.scene.batteries.count }));
  await until("both batteries, before the run begins", async () => (await drawn(shown)).batteries === 2);
  await shown.locator(by("score")).waitFor();
  assert.equal(await shown.locator(by("score")).innerText().then((text) => text.replace(/\s+/g, " ")), "red 2 : 0 blue");
  assert.equal((await drawn(shown)).links, 0);
  await shown.locator(by("play")).click();
  await until("a link", async () => (await drawn(shown)).links === 1);
  await picture(shown, "team");
  // Both are switched off where all overlays are, and then nothing is subscribed to.
  const subscribed = (topic) => shown.evaluate((name) => window.sandlot.client.subscriptions.has(name), topic);
  assert.equal(await subscribed("/sandlot/deliveries"), true);
  await shown.locator(by("overlays")).click();
  await shown.getByText("Communication links").click();
  await shown.getByText("Batteries").click();
  await shown.keyboard.press("Escape");
  assert.deepEqual([await subscribed("/sandlot/deliveries"), await subscribed("/sandlot/batteries")], [false, false]);
  assert.equal((await drawn(shown)).links, 0);
  assert.equal(await run.ended, 0, run.error);
  assert.equal(run.summary.state_hash, alone, "looking changes nothing");
  assert.equal((await shown.locator(by("score-red")).innerText()), "3");
  await shown.context().close();
  // A recording shows the same.
  const player = await Served.start(["replay", recording], scratch);
  const replayed = await open(player.url);
  await replayed.locator(by("play")).click();
  await until("a link", async () => (await drawn(replayed)).links === 1);
  assert.equal((await drawn(replayed)).batteries, 2);
  await replayed.context().close();
  assert.equal(await player.stop(), 0, player.error);
});

test("a world without media, batteries and teams has no score, and nothing more is asked for", { skip }, async () => {
  const run = await Served.start(["run", makeYard(scratch)], scratch);
  const shown = await open(run.url);
  await shown.locator(row("rover")).waitFor();
  const topics = await shown.evaluate(() => [...window.sandlot.client.subscriptions.keys()]);
  assert.deepEqual(topics.filter((name) => /deliveries|batteries/.test(name)), []);
  assert.equal(await shown.locator(by("score")).isVisible(), false);
  await shown.context().close();
  assert.equal(await run.stop(), 0, run.error);
});

test("who is connected, as what and how late is seen, and a client can be disconnected", { skip }, async () => {
  const yard = readFileSync(makeYard(scratch, { controller: "{kind: remote, deadline: 20 s}" }), "utf8")
    .replace("name: idle,", "name: idle, controller: {kind: remote, patience: 0 s},");
  const run = await Served.start(["run", scratch.write("remote.yaml", yard)], scratch);
  const viewer = await watch(run.ws);
  const shown = await open(run.url);
  await shown.locator(by("tab-clients")).click();
  const pane = shown.locator(by("clients"));
  const waiting = (robot) => pane.locator(`[data-program="${robot}/controller"]`);
  assert.match(await waiting("rover").innerText(), /Waits for a client/);
  // Each tenth answer is later than the deadline; the step after that comes in time.
  const client = new TcpClient(run.ws, (step) => (step % 10 === 0 ? 150 : 0));
  client.claim("rover", { mode: "lockstep", deadline_ms: 100, name: "brain.mjs" });
  await until("the claim", () => client.claimed);
  const row = pane.locator('[data-mode="lockstep"]');
  await row.waitFor();
  assert.match(await row.innerText(), /brain\.mjs[^]*rosbridge, TCP · 127\.0\.0\.1:\d+[^]*rover[^]*robot · lockstep/);
  assert.equal(await waiting("rover").count(), 0);
  assert.match(await waiting("idle").innerText(), /Waits for a client/);
  const misses = async () => Number(await row.locator(by("misses")).getAttribute("data-misses"));
  await until("a miss", async () => (await misses()) >= 2);
  assert.match(await row.locator(by("misses")).getAttribute("class"), /warn/);
  await until("the longest answer", async () => /s · 99 % in 1[5-9]\d ms/.test(await row.locator(by("latency")).innerText()));
  await viewer.say("pause");
  await state(viewer, "paused");
  const counted = await viewer.number("rover/controller.misses");
  await until("as many misses as the program counts", async () => (await misses()) === counted);
  assert.equal(await pane.locator(".you").filter({ hasText: "you" }).count() > 0, true);
  assert.equal(await pane.locator(".client-row.you").getByRole("button").count(), 0, "nobody sends himself away");
  await picture(shown, "clients");
  // A spectator sees itself.
  const url = new URL(run.url);
  url.searchParams.set("role", "spectator");
  const other = await open(url.href);
  await other.locator(by("tab-clients")).click();
  await other.locator(".client-row.you").waitFor();
  assert.equal(await other.locator(by("clients-count")).innerText(), "1 connected");
  assert.equal(await other.locator(by("clients")).locator("[data-mode=lockstep], [data-program]").count(), 0);
  await other.context().close();
  // Two clicks, and it is gone; its robot waits for another.
  const button = row.locator(by("disconnect"));
  await button.click();
  assert.equal(await button.innerText(), "Sure?");
  await button.click();
  await until("the end of the connection", () => client.ended);
  await row.waitFor({ state: "detached" });
  await waiting("rover").waitFor();
  await shown.context().close();
  viewer.close();
  assert.equal(await run.stop(), 0, run.error);
  const [summary] = run.summary.clients;
  assert.deepEqual([summary.name, summary.role, summary.drives, summary.mode, summary.misses], ["brain.mjs", "robot", "rover", "lockstep", counted]);
  assert.ok(summary.steps >= 10 && summary.latency_s.max >= 0.15 && summary.latency_s.mean < 0.1, JSON.stringify(summary));
});

test("a program that the run has started is restarted from the page, and what it writes is in the log", { skip }, async () => {
  chmodSync(scratch.folder, 0o755);  // also for `nobody`, when the tests run as root
  scratch.write("brain.py", `import os
print("begins as", os.getpid(), flush=True)
from sandlot_client import Robot
with Robot() as rover:
    for step in rover.steps():
        rover.command("drive", {"linear": {"x": 0.1}})
`);
  const yard = readFileSync(makeYard(scratch, { controller: "{kind: remote, command: [python3, brain.py], sandbox: off}" }), "utf8");
  const run = await Served.start(["run", scratch.write("started.yaml", yard)], scratch);
  const shown = await open(run.url);
  await shown.locator(by("tab-clients")).click();
  const program = shown.locator(`${by("clients")} [data-program="rover/controller"]`);
  const client = async () => Number(/Runs as client (\d+)/.exec(await program.innerText())?.[1] ?? 0);
  const first = await until("its client", client);
  assert.equal(await shown.locator(`${by("clients")} [data-client="${first}"] .who b`).innerText(), "brain.py");
  assert.match(await shown.locator(`${by("clients")} [data-client="${first}"]`).innerText(), /unix socket/);
  const restart = program.locator(by("restart-program"));
  await restart.click();
  assert.equal(await restart.innerText(), "Sure?");
  await restart.click();
  const second = await until("another client", async () => {
    const now = await client();
    return now > first && now;
  });
  await shown.locator(`${by("clients")} [data-client="${second}"] .who b`).waitFor();
  await picture(shown, "restarted");
  await program.locator(by("program-output")).click();
  const lines = shown.locator(".pane.log:visible .log-row");
  await until("its line", async () => (await lines.allInnerTexts()).some((text) => /rover\/controller\s+begins as \d+/.test(text)));
  assert.equal(await shown.locator(by("log-source")).inputValue(), "rover/controller");
  assert.equal((await lines.allInnerTexts()).every((text) => text.includes("rover/controller")), true, "no other source");
  await shown.context().close();
  assert.equal(await run.stop(), 0, run.error);
  const [summary] = run.summary.clients;
  assert.deepEqual([summary.name, summary.drives, summary.mode, summary.connections], ["brain.py", "rover", "lockstep", 2]);
});

test("in slow motion things glide between the steps, and the run is the same", { skip }, async () => {
  // 0.2 m/s in steps of 50 ms: 10 mm a step, one every half a second of the wall clock.
  const file = scratch.write("slow.yaml", `version: 1
time: {step: 50 ms, substeps: 10}
robots:
  - {name: rover, rate: 20 Hz, model: ${process.cwd()}/examples/eyesim_paper/bare.robi, controller: {kind: sequence, steps: [{at: 0 s, orders: {drive: [0.2, 0, 0]}}]}}
`);
  const alone = JSON.parse(execFileSync(sandlot, ["run", file, "--duration", "3s", "--json"], { stdio: "pipe" })).state_hash;
  const run = await Served.start(["run", file, "--duration", "3s", "--rate", "0.1"], scratch);
  const viewer = await watch(run.ws);
  const shown = await open(run.url);
  /** Where it is drawn, and where the latest message told it to be. */
  const look = () => shown.evaluate(() => {
    const { scene } = window.sandlot;
    const body = scene.bodies.by_name.get("rover");
    return body ? { x: scene.pose("rover").position[0], told: body.values[0] } : null;
  });
  const places = [];
  let between = 0;
  await until("frames between the steps", async () => {
    const at = await look();
    if (at === null) return false;
    places.push(at.x);
    const steps = Math.abs(at.told - at.x) / 0.01;
    if (Math.abs(steps - Math.round(steps)) > 0.05) between += 1;
    assert.ok(steps < 2.1, `it is ${steps} steps behind`);
    return between >= 5;
  }, 28);
  assert.ok(places.every((x, i) => i === 0 || x >= places[i - 1] - 1e-6), "it never goes back");
  await shown.locator(by("speed")).selectOption("50");
  assert.equal(await run.ended, 0, run.error);
  assert.equal(run.summary.state_hash, alone);
  viewer.close();
  await shown.context().close();
});
