// Runs example.mjs in node and in headless Chromium, and compares what they print.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';

// Both print as JSON: the formats of their consoles differ.
const print = 'console.log = (...values) => lines.push(JSON.stringify(values));';
const inNode = execFileSync(process.execPath, ['--input-type=module', '-e', `
  const lines = [];
  const log = console.log;
  ${print}
  await import('./example.mjs');
  log(lines.join('\\n'));`], { encoding: 'utf8' }).trim();
assert.equal(inNode.split('\n').length, 4);

const chromium = '/usr/bin/chromium';
if (!existsSync(chromium)) {
  console.log('not tested in a browser: there is no chromium');
  process.exit(0);
}
// The page sends what it printed, so it does not matter how long it takes.
const page = `<!DOCTYPE html><script type="importmap">
  {"imports": {"halfspace": "/node_modules/halfspace/index.js"}}</script>
  <script type="module">
  const lines = [];
  ${print}
  try { await import('/example.mjs'); } catch (error) { lines.push(String(error)); }
  await fetch('/printed', { method: 'POST', body: lines.join('\\n') });
  </script>`;
const server = createServer((request, response) => {
  if (request.url === '/printed') {
    request.on('data', (data) => { inBrowser += data; });
    request.on('end', () => response.end(() => browser.kill()));
  } else if (request.url === '/') {
    response.setHeader('Content-Type', 'text/html');
    response.end(page);
  } else {
    response.setHeader('Content-Type', 'text/javascript');
    createReadStream(`.${request.url}`).on('error', () => response.destroy()).pipe(response);
  }
});
let inBrowser = '';
let browser;
server.listen(0, '127.0.0.1', () => {
  const address = `http://127.0.0.1:${server.address().port}/`;
  browser = spawn(chromium, ['--headless', '--no-sandbox', '--disable-gpu', address],
    { stdio: 'ignore', timeout: 120000 });
  browser.on('exit', () => {
    server.closeAllConnections();
    server.close();
    assert.equal(inBrowser, inNode);
  });
});
