// test.mjs PAGE: opens the page in headless Chromium, and reads its verdict.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { hasChromium, postedBy } from '../../js/test/chromium.mjs';

if (!hasChromium) {
  console.log('not tested: there is no chromium');
  process.exit(0);
}
// Once, with a hundredth of the queries: times do not matter here.
const given = readFileSync(process.argv[2], 'utf8');
const page = given.replace("'6000'", "'60', '--repetitions', '1'");
assert.notEqual(page, given);
const reported = (html) => postedBy(`${html}<script>
  new MutationObserver(() => fetch('/posted', { method: 'POST', body: report.innerHTML }))
    .observe(document.getElementById('report'), { childList: true });
  </script>`);
// As in a browser without vectors.
const broken = page.replace(/^const programs = .*$/m,
  () => "const programs = ['Promise.reject(new Error(\\'no vectors\\'));', ''];");
assert.match(await reported(broken), /The measurement failed: Error: no vectors/);
const report = await reported(page);
console.log(report);
assert.match(report, /The simplex scan is faster than the box scan/);
for (const name of ['scalar', 'WASM, 4']) {
  assert.match(report, new RegExp(`\n {2}${name} .*\n`));
  assert.match(report, new RegExp(`<th class="n">${name} `));
}
assert.match(report, /costs an exact test of \d/);
const count = (what) => report.split(what).length - 1;
assert.equal(count('<tr>'), 1 + 7);
assert.equal(count('<td'), 3 * 7);
assert.equal(count('<polyline'), 2);
assert.doesNotMatch(report, /NaN|undefined|null/);
