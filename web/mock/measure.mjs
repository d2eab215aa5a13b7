// What a frame of the 3D view costs, in a headless browser against the mock server:
//
//   node mock/measure.mjs [--robots 1000] [--seconds 6] [--team no] [--browser /usr/bin/chromium] [--picture FILE]
//
// Medians over the seconds of the means per frame. No pixels are made (except for a picture): in a headless browser the
// processor would make them, and hold up the calls that are measured.
import { build } from 'esbuild';
import { chromium } from 'playwright-core';
import { spawn } from 'node:child_process';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

function option(name, fallback) {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? fallback : process.argv[at + 1];
}
const here = (file) => fileURLToPath(new URL(file, import.meta.url));

/** Builds the view, serves it, and gives a browser page that shows it; `close` ends all of it. */
export async function openView({ robots = 3, port = 8190, width = 1280, height = 800, theme = 'light', scale = 1, touch = false, paused = false, draws = true } = {}) {
  const dist = await mkdtemp(join(tmpdir(), 'sandlot-view-'));
  await build({ entryPoints: [here('view.ts')], bundle: true, minify: true, outfile: join(dist, 'main.js'), logLevel: 'error' });
  await writeFile(join(dist, 'index.html'), '<!doctype html><meta charset="utf-8"><title>view</title><style>html,body,#scene{margin:0;height:100%;overflow:hidden}</style><div id="scene"></div><script src="main.js"></script>');
  const server = spawn(process.execPath, [here('mock.mjs'), '--port', String(port), '--robots', String(robots), '--dist', dist, ...(paused ? ['--paused'] : [])], { stdio: ['ignore', 'pipe', 'inherit'] });
  await new Promise((resolve) => server.stdout.once('data', resolve));
  const browser = await chromium.launch({
    executablePath: option('browser', '/usr/bin/chromium'),
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-sandbox', '--disable-background-networking'],
  });
  const page = await browser.newPage({ viewport: { width, height }, deviceScaleFactor: scale, hasTouch: touch });
  const messages = new Set();
  page.on('console', (m) => messages.add(`${m.type()}: ${m.text()}`));
  page.on('pageerror', (e) => messages.add(`error: ${e.stack ?? e.message}`));
  if (!draws) {
    // Everything is handed over, nothing is drawn: else a processor that makes the pixels holds up the next call.
    await page.addInitScript(() => {
      for (const name of ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced']) WebGL2RenderingContext.prototype[name] = () => {};
    });
  }
  await page.goto(`http://127.0.0.1:${port}/?theme=${theme}&team=${option('team', 'yes')}`);
  const close = async () => {
    await browser.close();
    server.kill();
    await rm(dist, { recursive: true });
  };
  return { page, messages, close };
}

if (process.argv[1] === here('measure.mjs')) {
  const picture = option('picture', '');
  const view = await openView({ robots: Number(option('robots', '1000')), width: 800, height: 500, draws: picture !== '' });
  try {
    const seconds = [];
    await view.page.waitForTimeout(3000);
    for (let i = 0; i < Number(option('seconds', '6')); ++i) {
      await view.page.waitForTimeout(1000);
      seconds.push(await view.page.evaluate('scene.stats()'));
    }
    const middle = (name) => seconds.map((s) => s[name]).sort((a, b) => a - b)[seconds.length >> 1];
    const { draw_calls, triangles, instances } = seconds.at(-1);
    console.log(JSON.stringify({ fps: middle('fps'), script_ms: middle('script_ms'), submit_ms: middle('submit_ms'), draw_calls, triangles, instances }));
    if (picture) await view.page.screenshot({ path: picture });
    for (const message of view.messages) console.log(message);
  } finally {
    await view.close();
  }
}
