// Pages in headless Chromium.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';

const chromium = '/usr/bin/chromium';
export const hasChromium = existsSync(chromium);

// Opens `page`, from a server of this folder's files, and returns what it posts to
// /posted. So it does not matter how long the page takes. Once more if nothing came: on a
// busy machine, Chromium once showed no page.
export const postedBy = async (page) => (await postedOnce(page)) || postedOnce(page);

async function postedOnce(page) {
  let browser, posted = '';
  const server = createServer(async (request, response) => {
    if (request.url === '/posted') {
      for await (const data of request) posted += data;
      response.end(() => browser.kill());
    } else if (request.url === '/') {
      response.setHeader('Content-Type', 'text/html').end(page);
    } else {
      response.setHeader('Content-Type', 'text/javascript');
      createReadStream(`.${request.url}`).on('error', () => response.destroy()).pipe(response);
    }
  });
  await once(server.listen(0, '127.0.0.1'), 'listening');
  const address = `http://127.0.0.1:${server.address().port}/`;
  browser = spawn(chromium, ['--headless', '--no-sandbox', '--disable-gpu', address],
    { stdio: 'ignore', timeout: 150000 });
  await once(browser, 'exit');
  server.closeAllConnections();
  server.close();
  return posted;
}
