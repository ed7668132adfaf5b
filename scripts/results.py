#!/usr/bin/env python3
"""Makes docs/results.md, and README's table of speed, from bench/results/*.json.

    scripts/results.py           writes them, and README's figure
    scripts/results.py --check   fails if they are not what it would write, but for the
                                 figure, which cpuinfo-bench and gnuplot draw

Each file is a run's report on one machine:

    ./bench.sh --details all --format json --out bench/results/<machine>.json

README's table and figure are those of the newest run without options; the table stands
between two comments there.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SHAPES = ("simplex", "aabb", "aabo")
NAMES = {"simplex": "simplex", "aabb": "AABB", "aabo": "AABO"}
BEGIN = "<!-- speed: made by scripts/results.py -->\n"
END = "<!-- end of speed -->\n"


def number(value, digits=3):
    if value is None:
        return ""
    if isinstance(value, int):
        return f"{value:,}".replace(",", " ")
    return f"{value:.{digits}f}"


def table(head, rows):
    lines = ["| " + " | ".join(map(str, head)) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(map(str, row)) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def pivot(rows, keys, column, cell):
    """A table with a line for each value of `keys`, a column for each of `column`."""
    columns = list(dict.fromkeys(row[column] for row in rows))
    lines = {}
    for row in rows:
        lines.setdefault(tuple(row[key] for key in keys), {})[row[column]] = cell(row)
    return table([*keys, *columns],
                 [[*line, *(cells.get(c, "") for c in columns)]
                  for line, cells in lines.items()])


def machine(report, path):
    m = report["sections"]["machine"]
    context = report["context"]
    caches = ", ".join(f"L{c['level']} {c['size'] // 1024} KiB"
                       for c in context["caches"])
    options = f" {context['options']}" if context["options"] else ""
    text = (f"`cpuinfo-bench{options}` {m['version']}, {context['date'][:10]}, as "
            f"[{path.name}](../bench/results/{path.name}) has it: {m['system']}, "
            f"{m['cores']} cores, {caches}; {m['compiler']}, `{m['flags'].strip()}`, "
            f"Highway {m['highway']}; {m['targets']['chosen']} chosen of "
            f"{', '.join(m['targets']['supported'])}.")
    if m["virtual"]:
        text += " A virtual machine, whose neighbours disturb it: trust the ratios."
    return text + "\n"


def verdict(section):
    return "".join(f"- {sentence}\n" for sentence in section["sentences"])


def microseconds(nanoseconds):
    return number(None if nanoseconds is None else nanoseconds / 1e3)


def answers(section):
    return "".join(f"- {row['question']}: {row['answer']}\n" for row in section["answers"])


def model(section):
    return ("The AABB's cost over the simplex's in batches of w that stop after any "
            "half-space: by half-spaces expected and counted, by the time predicted, and "
            "measured.\n\n" +
            table(["w", "expected", "counted", "predicted", "measured"],
                  [[row["w"], *(number(row[by], 2)
                                for by in ("expected", "counted", "predicted")),
                    number(row["measured"]["median"], 2)]
                   for row in section["advantages"]]))


def sweep(section):
    def share(value):
        return "" if value is None else f"{100 * value:.1f} %"
    return (f"The fastest way to a list of survivors, each with an exact test of "
            f"{number(section['exact_ns'], 1)} ns ({section['exact_test']}).\n\n" +
            table(["size of objects", "objects", "fastest", "us a query", "survivors"],
                  [[share(cell["size"]), number(cell["objects"]),
                    cell["winner"] + (" (tie)" if cell["is_tie"] else ""),
                    number(cell["ns"] / 1e3), number(cell["survivors"], 1)]
                   for cell in section["cells"]]))


def threads(section):
    return pivot(section["rows"], ["work"], "threads",
                 lambda row: number(row["times"]["median"], 2) + " times")


def table1(section):
    rows = [[w, *(number(section["half_spaces"][s][i], 2) for s in SHAPES)]
            for i, w in enumerate(section["widths"])]
    rows.append(["accepts", *(number(section["accepts"][s]) for s in SHAPES)])
    return ("Half-spaces evaluated for an object, early-out in batches of w, and "
            "objects accepted.\n\n" + table(["w", *SHAPES], rows))


def crossover(section):
    def cell(row):
        if row["w_star"] is None:
            return "no crossover"
        return ("at most " if row["at_most"] else "") + number(row["w_star"], 0)
    return ("w\\*, from which on the simplex leads the AABB, with an early-out after "
            "every half-space.\n\n" +
            pivot(section["targets"], ["target", "lanes"], "working_set", cell))


def kernels(section):
    return ("ns an object, and the percentage of reading the same planes.\n\n" +
            pivot(section["rows"], ["shape", "schedule", "target"], "working_set",
                  lambda row: f"{number(row['ns_per_object'])} "
                              f"({number(row['percent_of_read'], 0)})"))


def build(section):
    text = ("ns an object (of sets: a point), and the percentage of copying the same "
            "bytes.\n\n" +
            pivot(section["rows"], ["shapes", "planes", "rounding", "target"],
                  "working_set",
                  lambda row: f"{number(row['ns_per_item'])} "
                              f"({number(row['percent_of_copy'], 0)})"))
    return text + "\n" + table(["one shape at a time", "ns"],
                               [[row["call"], number(row["ns_per_call"], 1)]
                                for row in section["singles"]])


def aims(ratios):
    met = sum(ratio["met"] for ratio in ratios)
    return (f"{met} of {len(ratios)} aims are met.\n\n" +
            table(["threshold", "ratio", "", "value", "aim"],
                  [[r["threshold"], r["name"], "met" if r["met"] else "missed",
                    number(r["value"], 2),
                    (">= " if r["better"] == "higher" else "<= ") +
                    number(r["needed"], 2)] for r in ratios]))


def throughput(section):
    text = aims(section["ratios"])
    # Threshold 7 has the sizes.
    rows = [row for row in section["rows"] if not re.search(r", \d/\d$", row["name"])]
    return text + "\n" + table(
        ["what", "set", "target", "objects", "queries", "ns a pair", "% of", "ceiling"],
        [[row["name"], row["working_set"], row["target"] or "", number(row["objects"]),
          number(row["queries"]), number(row["ns_per_pair"], 4),
          number(row["percent_of_ceiling"], 0), row["ceiling"] or ""]
         for row in rows])


def sorted_worlds(section):
    text = aims(section["ratios"])
    for load in section["workloads"]:
        text += (f"\n{load['name']}: {number(load['objects'])} boxes, of which a query "
                 f"finds {number(load['survivors_per_query'], 1)}; us a query, and times "
                 "as fast as the fastest competitor.\n\n")
        text += table(["what", "target", "us", "times", "in turns: us", "times"],
                      [[row["name"], row["target"] or "",
                        microseconds(row["ns_per_query"]), number(row["over_fastest"], 2),
                        microseconds(row["ns_per_query_in_turns"]),
                        number(row["over_fastest_in_turns"], 2)] for row in load["rows"]])
    return text + "\n" + table(["of all objects", "objects", "ms"],
                               [[row["name"], number(row["objects"]), number(row["ms"], 1)]
                                for row in section["jobs"]])


def quality(section):
    least = section["survivors"]["aabb"] or 1
    return (f"{number(section['objects'])} objects, {number(section['queries'])} "
            f"queries, of {section['workload']}.\n\n" +
            table(["", *SHAPES],
                  [["survivors", *(number(section["survivors"][s]) for s in SHAPES)],
                   ["of the AABB's", *(number(section["survivors"][s] / least, 2)
                                       for s in SHAPES)]]))


def segments(section):
    return ("Objects that a long segment in pieces keeps, on average.\n\n" +
            table(["direction", "length", "pieces", *SHAPES, "floor"],
                  [[row["direction"], f"{100 * row['length']:.0f} %", row["pieces"],
                    *(number(row["kept"][s], 1) for s in SHAPES),
                    number(row["floor"], 1)] for row in section["rows"]]))


SECTIONS = {"answers": answers, "verdict": verdict, "kernels": kernels, "throughput": throughput,
            "sorted": sorted_worlds, "build": build, "crossover": crossover,
            "model": model, "sweep": sweep, "threads": threads,
            "table1": table1, "quality": quality, "segments": segments}


def page(reports):
    text = ("# Results\n\nMade by `scripts/results.py` from the reports in "
            "[bench/results](../bench/results): what `cpuinfo-bench` found on each "
            "machine. [The tool](cpuinfo-bench.md) says how it measures, and "
            "[performance](performance.md) what binds the kernels.\n")
    for path, report in reports:
        text += f"\n## {report['context']['cpu']}\n\n{machine(report, path)}"
        for name, section in SECTIONS.items():
            if name in report["sections"]:
                text += f"\n### {name}\n\n{section(report['sections'][name])}"
    return text


def speed(path, report):
    """README's table: one query a working set; many queries; survivors."""
    sections = report["sections"]
    chosen = sections["machine"]["targets"]["chosen"]
    columns = (("simplex", "flat"), ("aabb", "flat"), ("aabb", "staged"),
               ("aabo", "staged"))

    def cells(value):
        return [value(shape, schedule) for shape, schedule in columns]

    rows = []
    kernel = {(r["working_set"], r["shape"], r["schedule"]): number(r["ns_per_object"])
              for r in sections["kernels"]["rows"] if r["target"] == chosen}
    for name in dict.fromkeys(key[0] for key in kernel):
        rows.append([name, *cells(lambda *key, name=name: kernel[(name, *key)])])
    many = {}
    for row in sections["throughput"]["rows"]:
        if row["working_set"] == "grid" and row["target"] == chosen:
            many[re.sub("^(simplex,|aabo floats|aabo uint8).*(counts|pairs).*",
                        r"\1 \2", row["name"])] = number(row["ns_per_pair"])
    rows.append(["many queries, a pair", many["simplex, counts"], "", "",
                 f"{many['aabo floats pairs']}; quantized {many['aabo uint8 pairs']}"])
    kept = sections["quality"]["survivors"]
    rows.append(["survivors, of the AABB's",
                 *cells(lambda shape, _: number(kept[shape] / kept["aabb"], 2))])
    m = sections["machine"]
    return (f"ns an object for one query, the paper's scene, {m['cpu']}, {chosen}, "
            f"{m['compiler']} ([the report](bench/results/{path.name})).\n\n" +
            table(["", *(f"{NAMES[shape]}, {schedule}" for shape, schedule in columns)], rows))


def figure(path):
    """The first figure of batches in the page of a report, as a file of its own."""
    tool = ROOT / "build/release/bench/cpuinfo-bench"
    if not tool.exists():
        sys.exit(f"{tool.relative_to(ROOT)} is missing, which draws README's figure: "
                 "run ./bench.sh --list")
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.html"
        subprocess.run([tool, "--report", page, "--render", path], check=True)
        html = page.read_text()
    drawn = re.search(r'<svg (viewBox="[^"]*") role="img" '
                      r'aria-label="Time by the width of a batch.*?</svg>', html, re.S)
    if not drawn:
        sys.exit("README's figure was not drawn: install gnuplot-nox")
    colours = re.search(r":root \{.*?\n\}\n@media.*?\n\}\n", html, re.S)
    style = colours[0] + ":root { background: var(--paper); color: var(--text); }\n"
    return drawn[0].replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1).replace(
        ">", f">\n<style>\n{style}</style>", 1) + "\n"


def with_speed(readme, path, report):
    if BEGIN not in readme or END not in readme:
        sys.exit(f"README.md has no line {BEGIN.strip()}, or none {END.strip()}")
    before, rest = readme.split(BEGIN)
    return before + BEGIN + speed(path, report) + END + rest.split(END)[1]


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    paths = sorted((ROOT / "bench/results").glob("*.json"))
    if not paths:
        sys.exit("bench/results has no report, which this makes: ./bench.sh --details "
                 "all --format json --out bench/results/<machine>.json")
    reports = [(path, json.loads(path.read_text())) for path in paths]
    # Of this table and figure: the newest run without options.
    newest = max((each for each in reports if not each[1]["context"]["options"]),
                 key=lambda each: each[1]["context"]["date"])
    readme = ROOT / "README.md"
    made = {ROOT / "docs/results.md": page(reports),
            readme: with_speed(readme.read_text(), *newest)}
    if not sys.argv[1:]:
        (ROOT / "docs/crossover.svg").write_text(figure(newest[0]))
    for path, text in made.items():
        if path.read_text() == text:
            continue
        if len(sys.argv) > 1:
            sys.exit(f"{path.relative_to(ROOT)} is not what the reports in "
                     "bench/results say: run scripts/results.py")
        path.write_text(text)


main()
