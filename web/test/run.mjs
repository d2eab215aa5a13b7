// Bundles each test/*.test.mjs with what it imports (TypeScript too) and hands the results to node's own test runner.
import {spawnSync} from 'node:child_process';
import {mkdtempSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {buildSync} from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const out = mkdtempSync(join(tmpdir(), 'sandlot-page-tests-'));
try {
  const tests = readdirSync(here).filter((name) => name.endsWith('.test.mjs'));
  buildSync({
    absWorkingDir: here,
    entryPoints: tests,
    outdir: out,
    outExtension: {'.js': '.mjs'},
    bundle: true,
    platform: 'node',
    format: 'esm',
    target: ['node18'],
    logLevel: 'warning',
  });
  const files = tests.map((name) => join(out, name));
  process.exitCode = spawnSync(process.execPath, ['--test', ...files], {stdio: 'inherit'}).status ?? 1;
} finally {
  rmSync(out, {recursive: true, force: true});
}
