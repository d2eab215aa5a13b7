// The pane Agents in a browser: what it draws is what the run publishes, its sliders tune, store and load act, and looking changes nothing.
import assert from "node:assert/strict";
import { existsSync, mkdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { Scratch, sandlot, Served, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const pictures = `${process.env.SANDLOT_BUILD ?? "build/release"}/page_tests`;
mkdirSync(pictures, { recursive: true });
const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
const skip = existsSync(executablePath) ? false : "there is no chromium";
const scratch = new Scratch();
const by = (id) => `[data-testid="${id}"]`;
const complaints = [];
let browser, run, page, viewer;

const robot = (name, x) => `  - name: ${name}
    model: ${join(process.cwd(), "models/rover")}
    pose: [${x}, 0, 0]
    controller:
      kind: selforg
      parameters: {epsC: 0.2}
      sensors:
        - {device: drive, value: twist.twist.linear.x, min: -0.5, max: 0.5}
        - {device: drive, value: twist.twist.angular.z, min: -2, max: 2}
      motors:
        - {device: drive, value: linear.x, min: -0.5, max: 0.5}
        - {device: drive, value: angular.z, min: -2, max: 2}
`;
const scenario = scratch.write("agents.yaml", `version: 1
name: agents
physics: planar
time: {step: 10 ms, control_interval: 2}
robots:
${robot("one", 0)}${robot("two", 3)}`);

async function say(line) {
  const answer = await viewer.say(line);
  assert.equal(answer.ok, true, `${line}: ${answer.text}`);
  return answer.text;
}
const parameter = async (path) => Number(/= (\S+)/.exec(await say(`show ${path}`))[1]);

before(async () => {
  if (skip) return;
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  run = await Served.start(["run", scenario], scratch);
  viewer = new Viewer(run.ws, "foxglove.websocket.v1");
  await viewer.subscribe("/sandlot/status", (s) => { viewer.status = s; });
  await until("a status", () => viewer.status);
  page = await (await browser.newContext({ viewport: { width: 1400, height: 900 } })).newPage();
  page.setDefaultTimeout(60000);
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await page.goto(run.url);
  await page.locator(by("tab-agents")).click();
});
after(async () => {
  viewer?.close();
  await browser?.close();
  await run?.stop();
  Served.killAll();
  scratch.remove();
});

test("its matrices are tiles with their sizes, and an element has all its digits", { skip }, async () => {
  assert.equal(await page.locator(by("agent")).inputValue(), "one/controller");
  const tile = page.locator(by("weights-C"));
  await tile.waitFor();
  assert.match(await tile.innerText(), /C\s*2 × 2\s*±\d/);
  for (const name of ["A", "S", "h", "b", "x", "y"]) await page.locator(by(`weights-${name}`)).waitFor();
  assert.match(await page.locator(".pane.agents .pane-head").innerText(), /sox behind one_to_one · 2 sensors, 2 motors/);
  await say("pause");
  await until("that it stands", () => viewer.status.state === "paused");
  const box = await tile.locator("canvas").boundingBox();
  await page.mouse.move(box.x + box.width * 0.75, box.y + box.height * 0.25);
  const shown = await until("the element", async () => /C\[0,1\] = (\S+)/.exec(await page.locator(".pane.agents .readout").innerText())?.[1]);
  // Row after row: element [0,1] is the second number of the message.
  const value = await parameter("one/controller/C.data[1]");
  assert.ok(Math.abs(Number(shown) - value) <= 1e-5 * Math.abs(value) + 1e-9, `${shown} and ${value}`);
  await page.screenshot({ path: `${pictures}/agents.png` });
  await say("run");
});

test("a slider tunes the agent, and a value out of range is refused in words", { skip }, async () => {
  const field = page.locator(by("param-one/controller.parameters.epsC"));
  await field.fill("0.35");
  await field.press("Enter");
  await until("the value", async () => (await parameter("one/controller.parameters.epsC")) === 0.35);
  assert.equal(await parameter("two/controller.parameters.epsC"), 0.2, "only this one");
  await field.fill("7");
  await field.press("Enter");
  await page.locator(".agent-form .field-error:visible").getByText("At most 5").waitFor();
  await field.press("Escape");
  assert.equal(await page.locator(by("param-one/controller.parameters.synboost")).isVisible(), false, "of other kinds of agents");
});

test("the network is drawn and tells of a node", { skip }, async () => {
  const canvas = page.locator(by("agent-network"));
  const colours = await canvas.evaluate((c) => {
    const { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height);
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add(`${data[i]} ${data[i + 1]} ${data[i + 2]}`);
    return seen.size;
  });
  assert.ok(colours > 20, `${colours} colours`);
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + 24 + (box.height - 30) / 4);
  await until("the node", async () => /^y0 = \S+: C\[0,\d\]/.test(await page.locator(".pane.agents .readout").innerText()));
});

test("what one learned is stored, and another one goes on from it", { skip }, async () => {
  // Files lie in the folder of the run.
  const name = `sandlot-agents-test-${process.pid}.agent`;
  const { rmSync } = await import("node:fs");
  try {
    await page.locator(by("agent-file")).fill(name);
    await page.locator(by("agent-store")).click();
    await until("the file", () => existsSync(name));
    await page.locator(by("agent")).selectOption("two/controller");
    await page.locator(by("agent-file")).fill(name);
    const steps = async () => Number(/two\/controller .* (\d+) steps/.exec(await say("list agents"))[1]);
    await say("pause");
    await until("that it stands", () => viewer.status.state === "paused");
    await page.locator(by("agent-load")).click();
    await page.getByText("two/controller goes on from").waitFor();
    await say("step 1");
    assert.equal(await parameter("two/controller.parameters.epsC"), 0.35, "with the parameters of the one that was stored");
    assert.ok((await steps()) > 0);
    await say("run");
  } finally {
    rmSync(name, { force: true });
  }
});

test("values against a value: a phase plot", { skip }, async () => {
  await page.locator(by("agent-phase")).click();
  const canvas = page.locator(by("phase-canvas"));
  await canvas.waitFor();
  const inked = () => canvas.evaluate((c) => {
    const { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height);
    let n = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 0 && Math.abs(data[i] - data[i + 2]) > 60) n += 1;
    return n;
  });
  await until("the curve", async () => (await inked()) > 100);
  await page.screenshot({ path: `${pictures}/phase.png` });
});

test("nothing was complained about, and looking changes nothing", { skip }, async () => {
  assert.deepEqual(complaints, []);
  const { execFileSync } = await import("node:child_process");
  const watched = await Served.start(["run", scenario, "--duration", "2s"], scratch);
  const other = await (await browser.newContext()).newPage();
  await other.goto(watched.url);
  await other.locator(by("tab-agents")).click();
  assert.equal(await watched.ended, 0, watched.error);
  await other.context().close();
  const alone = scratch.file("alone.json");
  execFileSync(sandlot, ["run", scenario, "--duration", "2s", "--summary", alone, "--headless"]);
  const { readFileSync } = await import("node:fs");
  assert.equal(watched.summary.state_hash, JSON.parse(readFileSync(alone, "utf8")).state_hash);
});
