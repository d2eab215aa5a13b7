// Takes the picture of the page's clients (docs/clients.md), in Debian's Chromium.
//
//   node tools/make_clients_picture.mjs [FILE] [WIDTH HEIGHT light|dark]      FILE is docs/images/clients.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { TcpClient } from "../tests/js/tcp_client.mjs";

const [file = "docs/images/clients.png", width = "1180", height = "700", colorScheme = "light"] = process.argv.slice(2);
const scratch = new Scratch();
const robots = [["red1", "red", -1.5, -1, 0.4], ["blue1", "blue", 1.2, 0.6, 2.4], ["red2", "red", -0.4, 1.4, -0.6], ["blue2", "blue", 1.4, -1.2, 1.8]];
const scenario = scratch.write("clients.yaml", `version: 1
name: four
physics: planar
time: {step: 10 ms, control_interval: 5}
seed: 1
robots:
${robots.map(([name, team, x, y, yaw]) => `  - {name: ${name}, team: ${team}, model: ${process.cwd()}/models/rover/model.sdf, pose: [${x}, ${y}, ${yaw}], controller: {kind: remote, patience: 2 s}}`).join("\n")}
`);
const served = await Served.start(["run", scenario], scratch);
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
// One keeps its deadline, one often comes close to it and sometimes beyond, one drives freely.
const quick = new TcpClient(served.ws, () => 1 + 3 * Math.random());
const slow = new TcpClient(served.ws, () => 6 + 10 * Math.random() + (Math.random() < 0.04 ? 30 : 0));
const free = new TcpClient(served.ws);
quick.claim("red1", { mode: "lockstep", deadline_ms: 50, name: "wander.py" });
slow.claim("blue1", { mode: "lockstep", deadline_ms: 20, name: "planner.js" });
free.claim("red2", { name: "drive.sh" });
const beat = setInterval(() => free.drive(0.2, 0.3), 100);
try {
  const page = await browser.newPage({ viewport: { width: +width, height: +height }, colorScheme });
  await page.addInitScript(() => localStorage.setItem("sandlot.frame.dock", "310"));
  await page.goto(served.url);
  await page.locator('[data-testid="tab-clients"]').evaluate((tab) => tab.click());
  await until("answers", () => quick.steps > 200 && slow.steps > 150, 60);
  await page.locator('[data-testid="misses"]').first().waitFor();
  await page.waitForTimeout(1500);
  await page.screenshot({ path: file });
} finally {
  clearInterval(beat);
  for (const client of [quick, slow, free]) client.close();
  await browser.close();
  await served.stop();
  scratch.remove();
}
