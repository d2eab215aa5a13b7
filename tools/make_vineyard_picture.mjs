// Takes the picture of docs/page.md on plans and estimates: MARIO in the vineyard, in Debian's Chromium. `./dev test` installs what it needs.
//
//   node tools/make_vineyard_picture.mjs [FILE]      FILE is docs/images/vineyard_page.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";
import { saveScreenshot } from "./indexed_png.mjs";

const file = process.argv[2] ?? "docs/images/vineyard_page.png";
// MARIO has turned into its second row: the ellipses differ most, by wheels alone, by eyes alone and by all sensors. It takes some minutes to get there.
const time_s = 43.6;
const scratch = new Scratch();
const served = await Served.start(["run", "scenarios/vineyard_loop.yaml", "--rate", "max", "--command", `at ${time_s} s pause`], scratch);
const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
let status;
await viewer.subscribe("/sandlot/status", (s) => { status = s; });
await until("the moment", () => status?.time_s >= time_s - 0.005, 1800);
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
try {
  const page = await browser.newPage({ viewport: { width: 960, height: 640 }, colorScheme: "light" });
  page.setDefaultTimeout(300000);
  await page.addInitScript(() => localStorage.setItem("sandlot.frame.folded", JSON.stringify({ left: true, right: true })));
  await page.goto(served.url);
  const by = (id) => page.locator(`[data-testid="${id}"]`);
  await by("tab-pictures").click();
  await by("add-picture").click();
  await by("picture-topic").nth(1).selectOption({ label: "mario/stereo/right/image" });
  await page.evaluate(() => {
    const { scene } = window.sandlot;
    scene.setOverlays({ names: false, trails: false, shadows: false });
    const { goal } = scene.rig;
    goal.target.set(6.4, 3.15, 0.4);
    Object.assign(goal, { distance: 3.5, azimuth: -Math.PI / 2 - 0.5, elevation: 1.05 });
    scene.rig.settle();
    scene.invalidate();
  });
  await page.waitForTimeout(6000);  // what is still being drawn
  await saveScreenshot(page, file);
} finally {
  await browser.close();
  viewer.close();
  await served.stop();
  scratch.remove();
}
