// Pages in headless Chromium.
import { spawn } from 'node:child_process';
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';

const chromium = '/usr/bin/chromium';
export const hasChromium = existsSync(chromium);

// Opens `page`, from a server of this folder's files, and returns what it posts to
// /posted. So it does not matter how long the page takes. Once more if nothing came: on a
// busy machine, Chromium once showed no page.
export async function postedBy(page) {
  return (await postedOnce(page)) || postedOnce(page);
}

function postedOnce(page) {
  return new Promise((resolve) => {
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
    }).listen(0, '127.0.0.1', () => {
      const address = `http://127.0.0.1:${server.address().port}/`;
      browser = spawn(chromium, ['--headless', '--no-sandbox', '--disable-gpu', address],
        { stdio: 'ignore', timeout: 150000 });
      browser.on('exit', () => {
        server.closeAllConnections();
        server.close();
        resolve(posted);
      });
    });
  });
}
