// A match on the page, in a browser as a person looks at it. Most of it is made up by the page's own stand-in for a server (web/mock), whose
// script is known to the second: what the page shows is held against that. At the end a run with a referee. Pictures stay in BUILD/page_tests.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { resolve } from "node:path";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { Scratch, Served, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const build = process.env.SANDLOT_BUILD ?? "build/release";
const pictures = `${build}/page_tests`;
mkdirSync(pictures, { recursive: true });
const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
const page_folder = resolve(process.env.SANDLOT_PAGE ?? `${build}/page`);
const skip = !existsSync(executablePath) ? "there is no chromium" : !existsSync("web/node_modules/ws") ? "there is no web/node_modules" : false;
const by = (id) => `[data-testid="${id}"]`;
const complaints = [];
const scratch = new Scratch();
let mock, browser, page, url;

async function open(theme, address = url) {
  const opened = await (await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: theme })).newPage();
  opened.setDefaultTimeout(60000);
  opened.on("pageerror", (error) => complaints.push(String(error)));
  opened.on("console", (message) => { if (message.type() === "error") complaints.push(message.text()); });
  await opened.goto(address);
  return opened;
}
const text = (id) => page.locator(by(id)).first().textContent();
const rows = () => page.locator(by("decision"));
/** What the page itself holds to be true: the client of the mock, asked by a line of its console. */
const say = (line) => page.evaluate((l) => window.sandlot.client.call("/sandlot/console", { line: l }), line);
const time_s = () => page.evaluate(() => window.sandlot.store.status?.time_s ?? -1);

before(async () => {
  if (skip) return;
  mock = spawn(process.execPath, ["web/mock/mock.mjs", "--match", "--port", "0", "--dist", page_folder]);
  let out = "";
  mock.stdout.on("data", (data) => { out += data; });
  url = await until("the address of the mock", () => /(http:\S+)/.exec(out)?.[1]);
  browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  page = await open("dark");
  await page.locator(by("board")).waitFor({ state: "visible" });
});
after(async () => {
  await browser?.close();
  mock?.kill();
  Served.killAll();
  scratch.remove();
});

test("the board has the referee's score and clock, not what a robot was told", { skip }, async () => {
  await say("pause");
  await say("jump 21.5");  // after the goal of cyan at 18 s; magenta's kick-off is taken
  await say("run");
  await until("the time", async () => (await time_s()) > 22.5);
  await say("pause");
  await until("the score", async () => (await text("board-cyan")) === "1");
  assert.equal(await text("board-magenta"), "0");
  assert.equal(await text("board-stage"), "First half");
  // What the robots' devices say is a layer that is off: the list of layers is folded, and hides nothing of the board.
  if (await page.locator(by("layers")).isVisible()) assert.equal(await page.locator(by("layers-fold")).getAttribute("aria-expanded"), "false");
  assert.match(await text("board"), /Tidal.*Ember/);
  assert.equal(await text("board-news"), "In play");
  // The clock of the game runs 3 s behind that of the run, which is paused: the latest state is up to 0.2 s old.
  const clock_s = (await time_s()) - 3;
  const [minutes, seconds] = (await text("board-clock")).split(":").map(Number);
  assert.ok(Math.abs(60 * minutes + seconds - clock_s) <= 2, `${minutes}:${seconds} at ${clock_s} s`);
});

test("the log has what happened before the page was opened, also after a reload", { skip }, async () => {
  for (const again of [false, true]) {
    if (again) await page.reload();
    await page.locator(by("tab-match")).click();
    await until("six decisions", async () => (await text("match-count")) === "6 decisions");
    const last = await rows().last().textContent();
    assert.match(last, /0:17.*Kick-off.*after a goal of cyan/);
    assert.match(await rows().nth(4).textContent(), /0:15.*Goal.*1 : 0/);
  }
});

test("new decisions come into the log, and into the time line as marks", { skip }, async () => {
  await say("run");
  await until("the yellow card", async () => /Yellow card/.test(await page.locator(".match-log").textContent()), 30);
  await say("pause");
  assert.equal(await page.locator(`${by("time-events")} .event.goal`).count(), 1);
  await until("the mark of the card", async () => (await page.locator(`${by("time-events")} .event.card`).count()) === 1);
  const mark = page.locator(`${by("time-events")} .event.goal`);
  assert.equal(await mark.evaluate((e) => getComputedStyle(e).backgroundColor), "rgb(18, 165, 201)", "the colour of cyan");
});

test("a decision opens its moment, drawn where everything was", { skip }, async () => {
  await page.locator(`${by("decision")}.goal`).first().click();
  await until("the caption", async () => /Goal: cyan \(1 : 0\)\. The whole ball is behind the goal line of magenta/.test(await text("match-caption")));
  assert.equal(await page.locator(`${by("field-picture")} .robot`).count(), 10);
  // The ball of the goal lies at x = 9 m, y = 0.4 m; y points up on the field and down in a picture.
  const ball = page.locator(`${by("field-picture")} .ball`);
  assert.deepEqual([await ball.getAttribute("cx"), await ball.getAttribute("cy")], ["9", "-0.4"]);
  assert.equal(await page.locator(`${by("field-picture")} .robot .ring`).count(), 1, "cyan4, which it is about, has a ring");
  await page.screenshot({ path: `${pictures}/match.png` });
});

test("a button jumps to the moment, and so does a click at its mark", { skip }, async () => {
  await page.locator(by("match-jump")).click();
  await until("the time of the goal", async () => Math.abs((await time_s()) - 18) < 0.011);
  // What comes later has not been.
  await until("five decisions", async () => (await text("match-count")) === "5 decisions");
  await page.locator(by("match-before")).click();
  await until("5 s before", async () => Math.abs((await time_s()) - 13) < 0.011);
  await say("jump 35");
  await until("35 s", async () => (await time_s()) > 34.9);
  // The line is as long as the run: the mark has moved.
  await until("the mark at half of the line", async () => {
    const left = await page.locator(`${by("time-events")} .event.goal`).evaluate((e) => Number.parseFloat(e.style.left));
    return Math.abs(left - (100 * 18) / 35) < 1;
  });
  const mark = await page.locator(`${by("time-events")} .event.goal`).boundingBox();
  await page.mouse.move(mark.x + mark.width / 2 + 3, mark.y + 4);
  assert.equal(await page.locator(".timeline .hint").textContent(), "18.00 s  Goal: cyan (1 : 0)");
  await page.mouse.down();
  await page.mouse.up();
  await until("the very time of the goal", async () => Math.abs((await time_s()) - 18) < 0.011);
});

test("possession, roles and maps follow the game", { skip }, async () => {
  await page.locator(by("match-view-ball")).click();
  await say("run");
  await until("heat", () => page.locator(".field-heat").isVisible(), 30);
  // 56 : 38 as the script has it.
  await until("possession", async () => (await text("possession")) === "60 %40 %");
  const keeper = page.locator(`${by("match-players")} [data-robot="cyan1"]`);
  await until("a role", async () => /Goalkeeper.*guard goal/.test(await keeper.textContent()));
  assert.equal(await page.locator(`${by("match-players")} .match-player`).count(), 10);
  await page.locator(by("match-view-passes")).click();
  await until("a pass", async () => (await page.locator(`${by("field-picture")} .pass`).count()) > 0, 30);
  assert.match(await text("match-caption"), /^Passes so far: cyan \d+, magenta \d+$/);
  await page.screenshot({ path: `${pictures}/match_passes.png` });
});

test("the camera of a robot opens from its row", { skip }, async () => {
  assert.equal(await page.locator(by("match-camera-cyan1")).isDisabled(), true, "it has none");
  await page.locator(by("match-camera-cyan2")).click();
  await page.locator(by("picture-topic")).waitFor();
  assert.equal(await page.locator(by("picture-topic")).inputValue(), "/cyan2/eye/image/compressed");
});

test("who comes late sees the same maps", { skip }, async () => {
  await say("pause");
  // Nothing moves any more: all that this one shows comes from the server.
  const late = await open("dark");
  await late.locator(by("tab-match")).click();
  await late.locator(by("match-view-passes")).click();
  await until("passes", async () => (await late.locator(`${by("field-picture")} .pass`).count()) > 3, 30);
  await late.locator(by("match-view-ball")).click();
  await until("heat", () => late.locator(".field-heat").isVisible(), 30);
  assert.match(await late.locator(by("match-caption")).first().textContent(), /^Ball in 0:[1-9]/);
  await late.context().close();
  await say("run");
});

test("in the light theme it reads as well", { skip }, async () => {
  await page.context().close();
  page = await open("light");
  await page.locator(by("tab-match")).click();
  await page.locator(`${by("decision")}.goal`).first().click();
  const colors = await page.locator(by("board-news")).evaluate((e) => [getComputedStyle(e).color, document.documentElement.dataset.theme]);
  assert.equal(colors[1], "light");
  await page.screenshot({ path: `${pictures}/match_light.png` });
});

test("a run with a referee: its decisions come late to who looks late, and go with a jump back", { skip }, async () => {
  await page.context().close();
  const run = await Served.start(["run", "tests/referee/goal.yaml", "--paused"], scratch);
  const probe = new Viewer(run.ws, "foxglove.websocket.v1");
  await probe.subscribe("/sandlot/status", (s) => { probe.status = s; });
  await until("a status", () => probe.status);
  const arrive = async (at_s) => {
    assert.equal((await probe.say(`jump ${at_s}`)).ok, true);
    await until(`${at_s} s`, () => Math.abs(probe.status.time_s - at_s) < 1e-6 && probe.status.state === "paused");
  };
  await arrive(5);
  page = await open("dark", run.url);
  await page.locator(by("tab-match")).click();
  await page.locator(`${by("decision")}.goal`).waitFor();
  const rules = () => page.locator(`${by("decision")} .rule`).allTextContents();
  assert.deepEqual((await rules()).slice(0, 4), ["Begin", "Start", "In play", "Goal"], "as the head of the file says");
  assert.equal(await text("board-cyan"), "1");
  await page.locator(`${by("decision")}.goal`).click();
  await until("three robots", async () => (await page.locator(`${by("field-picture")} .robot`).count()) === 3);
  await page.screenshot({ path: `${pictures}/match_referee.png` });
  const before = await rules();
  await page.locator(by("match-before")).click();
  await until("the time before the goal", () => probe.status.state === "paused" && probe.status.time_s < 1);
  await until("no goal in the log", async () => (await page.locator(`${by("decision")}.goal`).count()) === 0);
  await arrive(5);
  await until("the same decisions as before", async () => JSON.stringify(await rules()) === JSON.stringify(before));
  probe.close();
  await run.stop();
});

test("nothing went wrong in the browser", { skip }, () => assert.deepEqual(complaints, []));
