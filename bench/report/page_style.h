// The style sheet of the page. Inks are numbered as in figures.h; those from 5
// on are of winners that are no shape.
#ifndef HALFSPACE_BENCH_REPORT_PAGE_STYLE_H_
#define HALFSPACE_BENCH_REPORT_PAGE_STYLE_H_

namespace halfspace::bench {

inline constexpr const char* kPageStyle = R"css(
:root {
  color-scheme: light dark;
  --paper: #fffefb; --text: #1d1d1b; --soft: #62615c; --rule: #d8d6cf;
  --rgb2: 0 94 162; --rgb3: 196 78 0; --rgb4: 0 122 84;
  --rgb5: 133 66 140; --rgb6: 148 112 0; --rgb7: 104 104 104; --rgb8: 176 48 82;
  --ink0: currentColor; --ink1: var(--rule);
  --ink2: rgb(var(--rgb2)); --ink3: rgb(var(--rgb3)); --ink4: rgb(var(--rgb4));
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --paper: #161718; --text: #e6e4de; --soft: #a3a19a; --rule: #3a3b3c;
    --rgb2: 98 174 240; --rgb3: 244 150 84; --rgb4: 82 196 150;
    --rgb5: 206 148 212; --rgb6: 216 184 84; --rgb7: 168 168 168;
    --rgb8: 240 128 156;
  }
}
.ink2 { --rgb: var(--rgb2); } .ink3 { --rgb: var(--rgb3); }
.ink4 { --rgb: var(--rgb4); } .ink5 { --rgb: var(--rgb5); }
.ink6 { --rgb: var(--rgb6); } .ink7 { --rgb: var(--rgb7); }
.ink8 { --rgb: var(--rgb8); }
.t1 { background: rgb(var(--rgb) / .09); } .t2 { background: rgb(var(--rgb) / .17); }
.t3 { background: rgb(var(--rgb) / .25); } .t4 { background: rgb(var(--rgb) / .33); }
.t5 { background: rgb(var(--rgb) / .41); }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body {
  margin: 0 auto; padding: 2rem 1rem 4rem; max-width: 66rem;
  background: var(--paper); color: var(--text);
  font: 1.0625rem/1.5 Charter, "Bitstream Charter", Cambria, Georgia, serif;
  overflow-wrap: break-word;
}
h1, h2, h3, h4 { line-height: 1.2; font-weight: 600; text-wrap: balance; }
h1 { font-size: 1.75rem; margin: 0 0 .4rem; }
h2 { font-size: 1.3rem; margin: 2.75rem 0 .5rem; padding-top: .6rem;
  border-top: 1px solid var(--rule); }
h3 { font-size: 1.0625rem; margin: 1.25rem 0 .3rem; }
h4 { font-size: 1rem; margin: 1rem 0 .2rem; font-style: italic; }
p, ul { margin: .35rem 0; max-width: 44rem; }
ul { padding-left: 1.2rem; }
small, .soft, figcaption, summary { color: var(--soft); }
.soft, figcaption, summary, .notes { font-size: .9rem; }
.beside { display: grid; gap: 1rem 2rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 21rem), 1fr)); }
.beside > * { min-width: 0; }
figure { margin: 0; break-inside: avoid; }
figure h3 { margin-top: .5rem; }
.kinds { gap: 0 2rem; }
.wide { grid-column: 1 / -1; }
svg { display: block; width: 100%; max-width: 28rem; height: auto; }
svg text { font-family: ui-sans-serif, system-ui, "Helvetica Neue", Arial, sans-serif;
  font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; max-width: 100%; margin: .4rem 0; }
table { border-collapse: collapse; font-size: .875rem; line-height: 1.35;
  font-variant-numeric: tabular-nums lining-nums;
  border-top: 1.5px solid; border-bottom: 1.5px solid; }
thead { border-bottom: 1px solid; }
th, td { padding: .18rem .7rem .18rem 0; text-align: left; vertical-align: top;
  font-weight: 400; white-space: nowrap; }
th:last-child, td:last-child { padding-right: 0; }
thead th { font-style: italic; }
.words th, .words td { white-space: normal; padding: .5rem 1.2rem .5rem 0; }
.words tr + tr { border-top: 1px solid var(--rule); }
.words th[scope=row] { white-space: nowrap; width: 1%; }
.words tbody td { min-width: min(15rem, 60vw); max-width: 34rem; }
.words { font-size: 1rem; }
.machines td, .machines th { white-space: normal; max-width: 34rem; }
.map td, .map thead th { text-align: center; padding: .3rem .5rem; }
.map, .map thead { border: none; }
.map td { border: 2px solid var(--paper); }
.map thead th { white-space: normal; }
.map th[scope=colgroup] { text-align: left; }
.map tbody th { text-align: right; vertical-align: middle; }
.n { text-align: right; }
details { margin: .3rem 0; }
summary { cursor: pointer; }
details > details { margin-left: 1rem; }
@media (max-width: 30rem) {
  body { padding-top: 1rem; font-size: 1rem; }
  .words { font-size: .9375rem; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10pt; background: none; }
  .beside { grid-template-columns: repeat(2, minmax(0, 1fr)); }
  .scroll { overflow: visible; }
  details:not([open]), .numbers { display: none; }
  section:not(.wide), .map { break-inside: avoid; }
  h2, h3, h4, h2 + p { break-after: avoid; }
  tr { break-inside: avoid; }
  td { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
)css";

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_PAGE_STYLE_H_
