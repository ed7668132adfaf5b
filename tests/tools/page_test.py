#!/usr/bin/env python3
"""page_test.py schema|html PROJECT RUN.json...: that reports are as their schema says,
and that the page of them is well-formed HTML with what is in them. Exits with 77 where a
package is missing."""

import html.parser
import json
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
    text = subprocess.run([*tool, *paths], check=True, capture_output=True, text=True).stdout
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

# A page that refuses a file says which one, what is wrong with it and what to give.
damaged = dict(reports[0], tables=[{"name": "verdict"}])
for what, text in (("schema", '{"schema": 3}'), ("schema", "[]"), ("title", json.dumps(damaged)),
                   ("line 1", "no JSON")):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(text)
        file.flush()
        refused = subprocess.run([*tool, file.name], capture_output=True, text=True)
        assert refused.returncode == 1, refused
        for part in (file.name, what, "; give a file"):
            assert part in refused.stderr, refused
