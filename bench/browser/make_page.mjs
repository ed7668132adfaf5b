// make_page.mjs PAGE REPORT SCALAR VECTORS OUTPUT: the page with the style of
// cpuinfo-bench-report and with both programs in it.
import { readFileSync, writeFileSync } from 'node:fs';

const [page, report, scalar, vectors] = process.argv.slice(2).map((path, i) =>
  (i < 4 ? readFileSync(path, 'utf8') : path));
const style = report.match(/^STYLE = """([^]*?)"""/m)[1];
// A string of JavaScript that does not end the script that it is in.
const quoted = (text) => JSON.stringify(text).replaceAll('<', '\\u003c');
writeFileSync(process.argv[6], page.replace('/*STYLE*/', () => style)
  .replace('/*PROGRAMS*/', () => `${quoted(scalar)}, ${quoted(vectors)}`));
