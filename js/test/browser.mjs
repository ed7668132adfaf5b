// Runs example.mjs in node and in headless Chromium, and compares what they print.
import assert from 'node:assert/strict';
import { execFile, execFileSync } from 'node:child_process';
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { promisify } from 'node:util';

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
const page = `<!DOCTYPE html><script type="importmap">
  {"imports": {"halfspace": "/node_modules/halfspace/index.js"}}</script><pre></pre>
  <script type="module">
  const lines = [];
  ${print}
  try { await import('/example.mjs'); } catch (error) { lines.push(String(error)); }
  document.querySelector('pre').textContent = lines.join('\\n') + '\\nend';
  </script>`;
const server = createServer((request, response) => {
  if (request.url === '/') {
    response.setHeader('Content-Type', 'text/html');
    response.end(page);
  } else {
    response.setHeader('Content-Type', 'text/javascript');
    createReadStream(`.${request.url}`).on('error', () => response.destroy()).pipe(response);
  }
});
server.listen(0, '127.0.0.1', async () => {
  const { stdout } = await promisify(execFile)(chromium, ['--headless', '--no-sandbox',
    '--disable-gpu', '--virtual-time-budget=20000', '--dump-dom',
    `http://127.0.0.1:${server.address().port}/`]);
  const text = stdout.match(/<pre>([^]*)<\/pre>/)?.[1].replaceAll('&gt;', '>').trim();
  server.close();
  assert.equal(text, `${inNode}\nend`);
});
