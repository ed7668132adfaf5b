// Runs example.mjs in node and in headless Chromium, and compares what they print.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { hasChromium, postedBy } from './chromium.mjs';

// Both print as JSON: the formats of their consoles differ.
const print = 'console.log = (...values) => lines.push(JSON.stringify(values));';
const inNode = execFileSync(process.execPath, ['--input-type=module', '-e', `
  const lines = [];
  const log = console.log;
  ${print}
  await import('./example.mjs');
  log(lines.join('\\n'));`], { encoding: 'utf8' }).trim();
assert.equal(inNode.split('\n').length, 4);

if (hasChromium) {
  assert.equal(await postedBy(`<!DOCTYPE html><script type="importmap">
    {"imports": {"halfspace": "/node_modules/halfspace/index.js"}}</script>
    <script type="module">
    const lines = [];
    ${print}
    try { await import('/example.mjs'); } catch (error) { lines.push(String(error)); }
    await fetch('/posted', { method: 'POST', body: lines.join('\\n') });
    </script>`), inNode);
} else {
  console.log('not tested in a browser: there is no chromium');
}
