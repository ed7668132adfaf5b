#!/usr/bin/env python3
"""page_test.py schema|tables|html|claims PROJECT PAGE.json DETAILS.json [PAPER.json]: that
reports are as their schema says, that runs of all sections have their tables, and the counts in
them are right, that the page of them is well-formed HTML with what is in them, and that
scripts/results.py writes their figures and finds the claims that they do not support. Exits
with 77 where a package is missing."""

import html.parser
import importlib.util
import json
import math
import os
import re
import subprocess
import sys
import tempfile

check, project, runs = sys.argv[1], sys.argv[2], sys.argv[3:]
reports = [json.load(open(run, encoding="utf-8")) for run in runs]

if check == "schema":
    try:
        import jsonschema
    except ImportError:
        sys.exit(77)
    with open(f"{project}/docs/report.schema.json", encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft7Validator.check_schema(schema)
    errors = [error for report in reports
              for error in jsonschema.Draft7Validator(schema).iter_errors(report)]
    for error in errors:
        print("/".join(map(str, error.absolute_path)) + ":", error.message[:200])
    sys.exit(bool(errors))

if check == "tables":
    tables = {}
    # The page, cpuinfo-bench, and paper-bench where it was built.
    for report, folder in zip(reports[1:], ("sections", "paper")):
        tables = {table["name"]: table for table in report["tables"]}
        assert len(tables) == len(report["tables"]), sorted(t["name"] for t in report["tables"])
        with open(f"{project}/bench/{folder}/sections.def", encoding="utf-8") as file:
            sections = re.findall(r'^HALFSPACE_SECTION\("(\w+)"', file.read(), re.M)
        assert {name.split(":")[0] for name in tables} == set(sections), sections
        for name, table in tables.items():
            columns = table["columns"]
            keys = [tuple(str(row[c]) for c in range(len(columns)) if columns[c].get("key"))
                    for row in table["rows"]]
            assert all(len(row) == len(columns) for row in table["rows"]), name
            assert len(set(keys)) == len(keys), (name, keys)
            chart = table.get("chart", {"x": columns[0]["name"], "y": []}) if columns else {"y": []}
            assert {chart.get("x"), *chart["y"]} <= {c["name"] for c in columns} | {None}, name
        # "Not measured: other programs" stood in a run that was called quiet.
        if any(": not measured. Other programs" in note
               for note in tables.get("threads", {"notes": []}).get("notes", [])):
            assert report["context"]["noise"] == "noisy", report["context"]
        assert report["context"]["scope"].startswith("--quick --objects 4096 --queries 4")
    if "table1" not in tables:
        sys.exit()

    def value(name, row, column):
        cell = tables[name]["rows"][row][column]
        return cell[0] if isinstance(cell, list) else cell

    # Counts are the same on every machine.
    assert abs(value("table1", 6, 3) - 4) < 0.1
    assert len(tables["model: early-out"]["rows"]) == 7
    assert abs(value("model: early-out", 0, 1) - value("model: early-out", 0, 3)) < 1e-9
    assert value("model: early-out", 1, 3) > value("model: early-out", 1, 1)
    # Batches of objects that are sorted stop earlier.
    for row in 1, 2, 3:
        assert value("table1: sorted objects", row, 1) < 0.8 * value("table1: sorted objects", 0, 1)
    sys.exit()

if check == "claims":
    spec = importlib.util.spec_from_file_location("results", f"{project}/scripts/results.py")
    results = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(results)
    stored = results.stored(reports[0], [("mesh", reports[1]), ("", reports[1])])
    quality = next(t for t in reports[1]["tables"] if t["name"] == "quality")
    kept = quality["rows"][1][1]
    table = {"name": "t", "columns": [{"name": "size", "key": True}, {"name": "ratio"}],
             "rows": [["1 %", [1.2, 1.1, 1.3, "winner"]], ["3 %", [1.1, 0.9, 1.3]], ["all", 2]]}
    runs = {"here": {**stored, "tables": [*stored["tables"], table]}}
    for claim, is_so in (("t | size=1 % | ratio > 1", True), ("t | size=1 % | ratio > 1.15", False),
                         ("t | size=1 % | ratio < 1.4", True), ("t | size=3 % | ratio > 1", False),
                         ("t | size=3 % | ratio < 1", False), ("t | size=3 % | ratio = 1", True),
                         ("t | size=3 % | ratio <= 1", True), ("t | size=1 % | ratio <= 1", False),
                         ("t | size=all | ratio = 2", True), ("t | size=all | size = all", True),
                         ("t | | ratio > 0.8", True), ("t | | ratio > 1", False),
                         ("t | size=9 % | ratio > 1", False),
                         (f"quality | shape=simplex | survivors = {kept}", True),
                         (f"quality: mesh | shape=simplex | survivors > {kept}", False)):
        _, errors = results.filled(
            "p.md", "<!-- run: here -->\nA sentence.\n",
            [(1, "A sentence.", [(2, "claim", f"@ | {claim}")])], runs)
        assert (errors == []) == is_so, (claim, errors)

    # A figure, its words and its key: another sentence may change, and lines may break. What is
    # wrong is told with its file and line, and with what to do.
    size = "[p.md]\nis {} times\n  value: here | t | size=3 % | ratio\n"
    figure = "1.10 [0.90, 1.30]"
    for text, figures, after, error in (
            ("It is 7 times.", size, f"It is {figure} times.", None),
            ("Other words. It\nis 1.10 [0.90,\n1.30] times as fast.", size, None, None),
            ("It is 7 times, and 8.", size + "and {}.\n  value: here | t | size=all | ratio\n",
             f"It is {figure} times, and 2.00.", None),
            ("One.\nIt was 7 times.", size, None, "docs/figures.txt:2: p.md has no such words, "
             "with a figure for each {}. The most similar are near p.md:1. Copy"),
            ("It is many times.", size, None, "figures.txt:2: p.md has no such words"),
            ("It is 7 times.\nIs it? It is 8 times.", size, None,
             "figures.txt:2: p.md has these words in the lines 1 and 2: add words"),
            ("It is 7 times.", size.replace("| t", "| u"), None,
             'figures.txt:3: bench/results/here.json has no table "u": correct the key, or remove'),
            ("It is 7 times.", size.replace("here", "there"), None,
             "figures.txt:3: bench/results/there.json is missing"),
            ("It is 7 times.", size.replace("ratio", "rate"), None,
             'figures.txt:3: table "t" has no column "rate"'),
            ("It is 7 times.", size.replace("size=3 %", ""), None, "figures.txt:3: 3 rows fit"),
            ("It is 7 times.", size.replace(" | ratio", ""), None, 'figures.txt:3: "here | t'),
            ("It is 7 times.", size.replace("{} ", "7 "), None,
             "figures.txt:2: has 0 times {} and 1 values"),
            ("It is 7 times.", "[p.md]\nis 7 times\n", None, "figures.txt:2: has 0 times"),
            ("It is 7 times.", size + size[7:].replace("is", "It is"),
             f"It is {figure} times.",
             "figures.txt:5: p.md:1 has this figure from another key"),
            ("It is\n1.10 [0.90, 1.30] times.", "", None,
             f"p.md:2: {figure} is a figure without a key: write the words around it and its key"),
            ("A.<!-- claim: @ | t | size=all | ratio = 2 -->", "", None,
             "p.md:1: is no whole block"),
            ("<!-- results: here | t -->\nold\n", "", None, "p.md:1: is no whole block"),
            ("\n<!-- results: here | u -->\n<!-- end of results -->", "", None,
             'p.md:2: bench/results/here.json has no table "u"'),
            ("<!-- results: here | t | size=all -->\nis 1.10 [0.90, 1.30]\n"
             "<!-- end of results -->", "", "<!-- results: here | t | size=all -->\n| size | ratio |\n|---|---|\n"
             "| all | 2.00 |\n<!-- end of results -->", None)):
        entries = results.entries_of(figures).get("p.md", [])
        found, errors = results.filled("p.md", text, entries, runs)
        assert found == (after or text), (text, found)
        assert len(errors) == (error is not None) and (error or "") in "".join(errors), (text, errors)
    sys.exit()


class Page(html.parser.HTMLParser):
    """Checks that elements nest, and collects the text."""
    VOID = {"meta", "line", "polyline"}
    # Tables and charts are named by what they show, and by their section in small letters.
    heading, headings = None, ()

    def __init__(self):
        super().__init__()
        self.open, self.text, self.svgs, self.circles = [], "", 0, 0

    def handle_starttag(self, tag, attrs):
        self.svgs += tag == "svg"
        self.circles += tag == "circle"
        if tag == "h2":
            self.heading = ""
        assert not any(name in ("src", "href") for name, _ in attrs), attrs
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        assert tag in self.VOID, tag

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, (tag, self.getpos())
        if tag == "h2":
            self.headings = (*self.headings, self.heading)
            self.heading = None

    def handle_data(self, data):
        self.text += data
        if self.heading is not None and "small" not in self.open:
            self.heading += data


tool = [sys.executable, f"{project}/bench/cpuinfo-bench-report"]
for paths in (runs[:1], runs[1:], runs):
    page = Page()
    text = subprocess.run([*tool, *paths], check=True, capture_output=True,
                          encoding="utf-8").stdout
    page.feed(text)
    assert page.open == [], page.open
    assert "nan" not in text and "inf" not in text.replace("info", "")
    assert page.text.index("Simplex or box?") < page.text.index("verdict")
    for report in (r for r, run in zip(reports, runs) if run in paths):
        assert report["context"]["model"] in page.text
        for table in report["tables"]:
            is_shown = table["name"] in page.text
            assert is_shown or table["name"] == "noise", table["name"]
    # The verdict of each run has a chart, and its lines come first.
    verdicts = [table for report, run in zip(reports, runs) if run in paths
                for table in report["tables"] if table["name"] == "verdict"]
    assert page.svgs >= len(verdicts), page.svgs
    assert page.circles >= sum(len(table["chart"].get("marks", [])) for table in verdicts)
    for table in verdicts:
        assert all(line in page.text for line in table["lead"])
        assert page.text.index(table["lead"][0]) < page.text.index(table["title"])
    names = {table["name"] for report in reports for table in report["tables"]}
    assert not any(heading.strip() in names for heading in page.headings), page.headings
assert page.svgs >= 3, page.svgs


def refuse(content, *parts):
    """Checks that the page refuses a file of that content with one line, which names the
    file and has these parts."""
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(content)
        file.flush()
        refused = subprocess.run([*tool, file.name], capture_output=True, text=True)
        assert refused.returncode == 1 and refused.stderr.count("\n") == 1, (parts, refused)
        for part in (file.name, "; give a file", *parts):
            assert part in refused.stderr, refused


def report_of(rows):
    """A report with one table of two columns and a chart."""
    columns = [{"name": "x", "digits": 2}, {"name": "y", "digits": 2}]
    chart = {"x": "x", "y": ["y"], "series": "", "x_log": True, "y_log": False}
    table = {"name": "t", "title": "", "columns": columns, "rows": rows, "chart": chart}
    return {"schema": 4, "context": {"model": "m"}, "tables": [table]}


# A page that refuses a file says which one, what is wrong with it and what to give.
refuse('{"schema": 3}', "schema")
refuse("[]", "schema")
refuse("no JSON", "line 1")
refuse(json.dumps(dict(reports[0], tables=[{"name": "verdict"}])), "title")
refuse("[" * 100000, "RecursionError")
refuse(json.dumps(report_of([[1, 1], [2, 10 ** 400]])), "OverflowError")
refuse(json.dumps(report_of([["\ud800", 1]])), "surrogates")


def against(before, now, **context):
    """The exit code and the output of a comparison of two rows, of which y is better if lower."""
    paths = []
    for row, more in (before, {}), (now, context):
        report = report_of([row])
        report["tables"][0]["columns"][0]["key"] = True
        report["tables"][0]["columns"][1]["better"] = "lower"
        report["context"].update(more)
        with tempfile.NamedTemporaryFile("w", suffix=".json", delete=False) as file:
            json.dump(report, file)
        paths.append(file.name)
    run = subprocess.run([*tool, "--against", *paths], capture_output=True, text=True)
    for path in paths:
        os.remove(path)
    return run.returncode, run.stdout + run.stderr


# Worse is what differs by more than a tenth, and from the range, in the worse direction.
was = [1, [1.0, 0.9, 1.1]]
for now, code in (([1, [1.09, 1.2, 1.2]], 0), ([1, [1.3, 1.05, 1.5]], 0), ([1, 0.5], 0),
                  ([1, [1.3, 1.2, 1.5]], 5), ([1, 1.3], 5), ([2, 1.0], 1), ([1, None], 1)):
    assert against(was, now)[0] == code, now
assert "t, 1, y: 1.30, was 1.00\n1 of 1 values" in against(was, [1, 1.3])[1]
assert against(was, was, model="other")[0] == 1

# Where two x are so near that their logarithms are equal, there is no line between them.
with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
    json.dump(report_of([[1e300, 1], [math.nextafter(1e300, math.inf), 2]]), file)
    file.flush()
    subprocess.run([*tool, file.name], check=True, capture_output=True)

# Both ends of an axis have labels, which are inside of the chart.
with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
    json.dump(report_of([[1, 1], [20, 2], [30, 3]]), file)
    file.flush()
    chart = subprocess.run([*tool, file.name], check=True, capture_output=True, text=True).stdout
width, last = (float(re.search(what, chart)[1]) for what in
               (r'viewBox="0 0 (\d+)', r'<text x="([\d.]+)"[^>]*>30</text>'))
assert last + 20 < width, (last, width)

# The page is UTF-8 whatever the locale is.
latin = subprocess.run([*tool, runs[0]], check=True, capture_output=True,
                       env=dict(os.environ, PYTHONIOENCODING="latin-1")).stdout
assert latin == subprocess.run([*tool, runs[0]], check=True, capture_output=True).stdout
latin.decode()

if os.path.exists("/dev/full"):
    for arguments in ([runs[0]], ["--help"]):
        with open("/dev/full", "w") as full:
            failed = subprocess.run([*tool, *arguments], stdout=full, stderr=subprocess.PIPE,
                                    text=True)
        assert failed.returncode == 1, failed
        assert failed.stderr.count("\n") == 1 and "standard output" in failed.stderr, failed
