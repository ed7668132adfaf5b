#!/usr/bin/env python3
"""Draws the charts of docs/choosing.md from a stored run, by the charts of cpuinfo-bench-report.

    scripts/charts.py           writes docs/crossover.svg and docs/query-time.svg
    scripts/charts.py --check   fails if they are not what it would write
"""

import importlib.machinery
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
RUN = ROOT / "bench/results/xeon-6-167.json"

# Each chart: its title, the table, and the parts of the table's `chart` that differ.
CHARTS = {
    "crossover": ("The time of the box scan over the simplex scan, by the size of objects",
                  "verdict", {}),
    "query-time": ("The time of a query by the number of objects",
                   "answers: structures", {"y": ["scan", "quantized", "BVH"]}),
}

# As attributes and plain colours: some renderers know no CSS variables. The colours of lines
# can be read on a dark page too.
STYLE = ("<style>text { fill: #333 } .grid { stroke: #ccc } "
         "@media (prefers-color-scheme: dark) { text { fill: #ddd } .grid { stroke: #444 } }</style>")
COLOURS = {"s0": "#1f83d4", "s1": "#d9660f", "s2": "#2f9e44", "s3": "#a04fc0", "s4": "#a8860b",
           "s5": "#d6336c", "text": "#888"}


def drawn():
    # Without a file of its bytecode next to it.
    sys.dont_write_bytecode = True
    report = importlib.machinery.SourceFileLoader(
        "report", str(ROOT / "bench/cpuinfo-bench-report")).load_module()
    tables = {table["name"]: table for table in json.loads(RUN.read_text())["tables"]}
    for name, (title, table, changes) in CHARTS.items():
        table = tables[table]
        svg = report.chart_html(
            {**table, "title": title, "chart": {**table["chart"], **changes}}, width=400)
        svg = re.sub(r"var\(--(\w+)\)", lambda m: COLOURS[m[1]], svg)
        svg = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" '
                          'font-size="12" ', 1).replace(">", f">\n{STYLE}\n", 1)
        yield ROOT / f"docs/{name}.svg", svg.replace("/><", "/>\n<") + "\n"


def main():
    for path, svg in drawn():
        if sys.argv[1:] == ["--check"]:
            if not path.exists() or path.read_text() != svg:
                sys.exit(f"{path.relative_to(ROOT)} is not what {RUN.name} says: run scripts/charts.py")
        elif sys.argv[1:]:
            sys.exit(__doc__)
        else:
            path.write_text(svg)


if __name__ == "__main__":
    main()
