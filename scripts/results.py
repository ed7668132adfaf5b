#!/usr/bin/env python3
"""Writes docs/results.md, and the figures in README.md and docs/*.md that come from the
stored runs in bench/results/*.json.

    scripts/results.py           writes them
    scripts/results.py --check   fails if a file is not what it would write

A run of one machine:

    ./bench.sh --details all --format json --out bench/results/<machine>.json

A block in a document, whose lines this replaces with a table of a run:

    <!-- results: <machine> | <table> [| <column>=<value>,..., notes or lead] -->
    <!-- end of results -->

A single value, which this replaces with the cell of the one row that fits:

    <!--= <machine> | <table> | <column>=<value>,... | <column> -->1.23<!--/-->
"""

import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"(<!-- results: (.*?) -->\n).*?(<!-- end of results -->)", re.S)
VALUE = re.compile(r"(<!--= (.*?) -->).*?(<!--/-->)", re.S)


def number(value, digits):
    if value is None:
        return ""
    return f"{value:,.{digits}f}".replace(",", " ")


def cell(value, column):
    """The text of a cell: a value, its spread in brackets, and its flag."""
    low = high = flag = None
    if isinstance(value, list):
        flag = value[3] if len(value) > 3 else None
        value, low, high = value[:3]
    digits = column.get("digits", 2)
    text = value if isinstance(value, str) else number(value, digits)
    if low is not None and high is not None:
        text += f" [{number(low, digits)}, {number(high, digits)}]"
    if flag == "winner":
        return f"**{text}** *"
    return text + {"tie": " =", "met": " met", "missed": " missed"}.get(flag, "")


def table_of(runs, machine, name):
    if machine not in runs:
        sys.exit(f"bench/results/{machine}.json is missing")
    for table in runs[machine]["tables"]:
        if table["name"] == name:
            return table
    sys.exit(f"bench/results/{machine}.json has no table \"{name}\"")


def rows_of(table, conditions):
    """The rows whose cells are as `column=value,...` says."""
    names = [column["name"] for column in table["columns"]]
    rows = table["rows"]
    for condition in filter(None, re.split(r",(?=[^,=]+=)", conditions)):
        name, value = condition.strip().split("=", 1)
        if name not in names:
            sys.exit(f"table \"{table['name']}\" has no column \"{name}\"")
        at = names.index(name)
        rows = [row for row in rows if cell(row[at], table["columns"][at]) == value]
    return rows


def markdown(table, rows):
    columns = table["columns"]
    head = [c["name"] + (f", {c['unit']}" if c.get("unit") else "") for c in columns]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(map(cell, row, columns)).replace("\n", " ") + " |"
              for row in rows]
    return "\n".join(lines) + "\n"


def block(runs, spec):
    machine, name, *conditions = (part.strip() for part in spec.split("|"))
    table = table_of(runs, machine, name)
    # Runs of older versions have no such lines: their table says the same.
    if conditions == ["lead"] and "lead" in table:
        return "".join(f"    {line}\n" for line in table["lead"])
    if conditions == ["lead"]:
        return f"{table['title']}:\n\n{markdown(table, table['rows'])}"
    if conditions == ["notes"]:
        return "".join(f"- {note}\n" for note in table["notes"])
    rows = rows_of(table, conditions[0] if conditions else "")
    text = markdown(table, rows) if rows else ""
    notes = "" if conditions else "".join(f"\n{note}\n" for note in table.get("notes", []))
    return text + notes


def single(runs, spec):
    machine, name, conditions, column = (part.strip() for part in spec.split("|"))
    table = table_of(runs, machine, name)
    rows = rows_of(table, conditions)
    names = [c["name"] for c in table["columns"]]
    if len(rows) != 1 or column not in names:
        sys.exit(f"{len(rows)} rows fit \"{spec}\", or it has no such column")
    at = names.index(column)
    value = rows[0][at]
    without_flag = value[:3] if isinstance(value, list) else value
    return cell(without_flag, table["columns"][at])


def filled(text, runs):
    text = BLOCK.sub(lambda m: m[1] + block(runs, m[2]) + m[3], text)
    return VALUE.sub(lambda m: m[1] + single(runs, m[2]) + m[3], text)


def page(runs):
    """docs/results.md: every table of every run."""
    text = ("# Results\n\n`scripts/results.py` makes this page from the runs in "
            "[bench/results](../bench/results). [The tool](cpuinfo-bench.md) describes how "
            "it measures. `bench/cpuinfo-bench-report` draws the same runs.\n")
    for machine, run in runs.items():
        context = run["context"]
        text += (f"\n## {machine}\n\n{context['cpu']} ({context['model']}), "
                 f"{context['caches']}, {context['cores']} cores, {context['machine']}; "
                 f"{context['system']}; ")
        if context["scope"] == "python":  # by a script in bench/python
            text += (f"{context['flags']}; halfspace {context['version']}, "
                     f"`{context['command']}`, {context['date'][:10]}.\n")
        else:
            text += (f"{context['compiler']}, `{context['flags'].strip()}`, "
                     f"Highway {context['highway']}; cpuinfo-bench {context['version']} "
                     f"`{context['command']}`, {context['date'][:10]}; "
                     f"a {context.get('noise', 'not measured as quiet or noisy')} run.\n")
        for table in run["tables"]:
            text += f"\n### {table['name']}\n\n{table['title']}\n\n"
            text += block(runs, f"{machine} | {table['name']}")
    return text


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    paths = sorted((ROOT / "bench/results").glob("*.json"))
    runs = {path.stem: json.loads(path.read_text()) for path in paths}
    made = {ROOT / "docs/results.md": page(runs)}
    for document in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        if document not in made:
            made[document] = filled(document.read_text(), runs)
    for document, text in made.items():
        if document.exists() and document.read_text() == text:
            continue
        if sys.argv[1:]:
            sys.exit(f"{document.relative_to(ROOT)} is not what the runs in bench/results "
                     "say: run scripts/results.py")
        document.write_text(text)


if __name__ == "__main__":
    main()
