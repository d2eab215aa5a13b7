// Error models of a .sim by sliders on the page: they change the running world for all robots, and enter its log, so that a replay has them.
// Pictures stay in BUILD/page_tests.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { Scratch, Served, sandlot, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const pictures = `${process.env.SANDLOT_BUILD ?? "build/release"}/page_tests`;
mkdirSync(pictures, { recursive: true });
const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
const skip = existsSync(executablePath) ? false : "there is no chromium";
const scratch = new Scratch();
const recording = scratch.file("run.mcap");
let browser, served, page, probe;
const complaints = [];
const heard = { left: [], right: [] };

const by = (id) => `[data-testid="${id}"]`;
const models = by("error-models");
const input = (address) => page.locator(`${models} ${by(`param-${address}`)}`);
/** Moves a slider as a hand does. */
const slide = (address, value) => page.locator(`${models} .field-cell:has(${by(`param-${address}`)}) input[type=range]`).evaluate((slider, to) => {
  slider.value = String(to);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  slider.dispatchEvent(new Event("change", { bubbles: true }));
}, value);

before(async () => {
  if (skip) return;
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic",
      "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  scratch.write("room.wld", "floor 2000 2000\n0 0 2000 0\n2000 0 2000 2000\n2000 2000 0 2000\n0 2000 0 0\n");
  served = await Served.start(["run", scratch.write("two.sim", "world room.wld\nS4 500 500 0\nLabBot 500 1500 0\n"), "--record", recording], scratch);
  probe = new Viewer(served.ws, "foxglove.websocket.v1");
  await probe.subscribe("/S4/PSD_FRONT/range", (m) => heard.left.push(m.range));
  await probe.subscribe("/LabBot/PSD_FRONT/range", (m) => heard.right.push(m.range));
  page = await (await browser.newContext({ viewport: { width: 1280, height: 1000 } })).newPage();
  page.setDefaultTimeout(60000);
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await page.goto(served.url);
});
after(async () => {
  probe?.close();
  await browser?.close();
  await served?.stop();
  Served.killAll();
  scratch.remove();
});

/** Largest difference among the latest values. */
const spread = (values) => Math.max(...values.slice(-20)) - Math.min(...values.slice(-20));

test("a robot that stands sees a wall that stands", { skip }, async () => {
  await until("ranges", () => heard.left.length > 20 && heard.right.length > 20);
  assert.equal(spread(heard.left), 0);
});

test("the world has sliders for the error models of all robots", { skip }, async () => {
  await page.locator(models).waitFor();
  for (const address of ["S4/PSD_FRONT.noise.stages[0].gaussian.std", "S4/drive.command_errors.linear.stages[0].gaussian.std",
    "S4/drive.command_errors.angular.stages[0].gaussian.std", "S4/camera.noise.stages[0].gaussian.std", "S4/camera.noise.stages[1].salt_and_pepper.salt",
    "S4/camera.noise.stages[2].hundreds_and_thousands.rate", "media/air.bit_error_rate", "media/air.drop"])
    assert.equal(await input(address).count(), 1, address);
  await slide("S4/PSD_FRONT.noise.stages[0].gaussian.std", 0.05);
  const before = [heard.left.length, heard.right.length];
  await until("further ranges", () => heard.left.length > before[0] + 40 && heard.right.length > before[1] + 40);
  // Of 20 normal values with a deviation of 5 cm, that all lie within 4 cm has a probability below 1e-9.
  assert.ok(spread(heard.left) > 0.04, `S4: ${spread(heard.left)}`);
  assert.ok(spread(heard.right) > 0.04, `LabBot: ${spread(heard.right)}`);
  await slide("S4/camera.noise.stages[2].hundreds_and_thousands.rate", 0.1);
  await input("media/air.drop").fill("0.5");
  await input("media/air.drop").press("Enter");
  await until("the answer", async () => (await page.locator(`${models} .pending`).count()) === 0);
  await page.screenshot({ path: `${pictures}/error_models.png` });
});

test("a device shows its own, and what is fixed as it is", { skip }, async () => {
  await page.locator(`${by("tree")} [data-address="S4"]`).click();
  await page.locator(`${by("part-S4/PSD_LEFT")}`).click();
  await page.locator(`${models} ${by("param-S4/PSD_LEFT.noise.stages[0].gaussian.std")}`).waitFor();
  const shown = await until("the value", async () => {
    const value = await input("S4/PSD_LEFT.noise.stages[0].gaussian.std").inputValue();
    return value !== "" && value;
  });
  assert.equal(shown, "0.05");
  // S4's file says up to 9999 mm; the default of the kind is 4 m.
  await page.locator("details.fixed-fields summary").click();
  await until("the range of this sensor", async () => (await page.locator(by("param-S4/PSD_LEFT.max_range")).inputValue()) === "9.999");
});

test("what the sliders did is in the recording, and a replay does it again", { skip }, async () => {
  assert.deepEqual(complaints, []);  // before the page calls a server that has ended
  assert.equal(await served.stop(), 0);
  const out = execFileSync(sandlot, ["replay", recording], { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
  assert.match(out, /^replayed +\d+ ticks/m);
});
