// Builds the page: node build.mjs --out DIR [--watch]. Writes index.html, main.js and style.css, which are all there is at run time;
// nothing is loaded from elsewhere, so that the page works without a network and under a strict content security policy.
import {copyFile, mkdir} from 'node:fs/promises';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import * as esbuild from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const argument = (name) => {
  const at = process.argv.indexOf(name);
  return at < 0 ? undefined : process.argv[at + 1];
};
const out = resolve(argument('--out') ?? join(here, 'dist'));
const watch = process.argv.includes('--watch');

const copyPage = {
  name: 'copy-page',
  setup(build) {
    build.onEnd(async (result) => {
      if (result.errors.length === 0) await copyFile(join(here, 'src/index.html'), join(out, 'index.html'));
    });
  },
};

const options = {
  absWorkingDir: here,
  entryPoints: {main: 'src/main.ts', style: 'src/style/style.css'},
  outdir: out,
  bundle: true,
  minify: !watch,
  sourcemap: watch ? 'inline' : false,
  format: 'esm',
  target: ['es2021'],
  charset: 'utf8',
  legalComments: 'none',
  logLevel: 'warning',
  plugins: [copyPage],
};

await mkdir(out, {recursive: true});
if (watch) {
  const context = await esbuild.context(options);
  await context.watch();
} else {
  await esbuild.build(options);
}
