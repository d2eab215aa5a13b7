// Takes the README's picture: the yard on its page, in Debian's Chromium. `./dev test` installs what it needs.
//
//   node tools/make_page_picture.mjs [FILE]      FILE is docs/images/page.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";

const file = process.argv[2] ?? "docs/images/page.png";
const scratch = new Scratch();
const served = await Served.start(["demo", "yard"], scratch);
const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
let status;
await viewer.subscribe("/sandlot/status", (s) => { status = s; });
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 760 }, colorScheme: "light" });
  await page.goto(served.url);
  const by = (id) => page.locator(`[data-testid="${id}"]`);
  await page.locator('[data-testid="tree"] [data-address="porter"]').click();
  await by("tab-plots").click();
  for (const value of ["porter.pose.x", "porter.pose.y", "porter.pose.z"]) {
    await by("plot-input").first().fill(value);
    await by("plot-input").first().press("Enter");
    await by("plot-input").first().press("Escape");
  }
  // Porter stands on the bridge, and the pendulums are out of step.
  await until("a good moment", () => status?.time_s > 20, 120);
  await viewer.say("pause");
  await page.locator('[data-testid="tree"] [data-address="porter"]').click();
  await page.mouse.move(600, 270);
  for (let i = 0; i < 4; ++i) await page.mouse.wheel(0, -100);
  await page.mouse.move(1270, 420);
  await page.waitForTimeout(2000);  // what is still being drawn
  await page.screenshot({ path: file });
} finally {
  await browser.close();
  viewer.close();
  await served.stop();
  scratch.remove();
}
