#!/usr/bin/env python3
"""Writes docs/results.md, and the figures in README.md and docs/*.md that come from the
stored runs in bench/results/*.json. Then checks the sentences that are marked as claims.

    scripts/results.py           writes them
    scripts/results.py --check   fails if a file is not what it would write
    scripts/results.py --store MACHINE RUN.json [NAME=RUN.json ...]
                                 stores a run as bench/results/MACHINE.json, with the commit
                                 of the working tree. The tables of a
                                 run of a mesh are stored with ": NAME" behind their names;
                                 with an empty NAME only those that the first run lacks

A run of one machine:

    ./bench.sh --details all --format json --out run.json
    scripts/results.py --store <machine> run.json

A block in a document, whose lines this replaces with a table of a run:

    <!-- results: <machine> | <table> [| <column>=<value>,..., notes or lead] -->
    <!-- end of results -->

A single value, which this replaces with the cell of the one row that fits:

    <!--= <machine> | <table> | <column>=<value>,... | <column> -->1.23<!--/-->

A claim after a sentence, which must hold in all rows that fit, at least one. With a
range, > and < are true if the whole range is on that side, and >= and <= if a part of it is. = is
true if the number is in the range, or if the cell has this text:

    <!-- claim: <machine> | <table> | <column>=<value>,... | <column> > 1 -->

In a document with <!-- run: <machine> -->, "@" is that machine.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"(<!-- results: (.*?) -->\n).*?(<!-- end of results -->)", re.S)
VALUE = re.compile(r"(<!--= (.*?) -->).*?(<!--/-->)", re.S)
RUN = re.compile(r"<!-- run: (\S+) -->")
CLAIM = re.compile(r"<!-- claim: (.*?) -->", re.S)


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
    return text + {"tie": " ="}.get(flag, "")


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


def parts_of(spec, this):
    """The parts of a mark, with the run of its document in place of "@"."""
    machine, *parts = (" ".join(part.split()) for part in spec.split("|"))
    return [this if machine == "@" else machine, *parts]


def run_of(text):
    found = RUN.search(text)
    return found[1] if found else "@"


def markdown(table, rows):
    columns = table["columns"]
    head = [c["name"] + (f", {c['unit']}" if c.get("unit") else "") for c in columns]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(map(cell, row, columns)).replace("\n", " ") + " |"
              for row in rows]
    return "\n".join(lines) + "\n"


def block(runs, spec, this=None):
    machine, name, *conditions = parts_of(spec, this)
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


def single(runs, spec, this):
    machine, name, conditions, column = parts_of(spec, this)
    table = table_of(runs, machine, name)
    rows = rows_of(table, conditions)
    names = [c["name"] for c in table["columns"]]
    if len(rows) != 1 or column not in names:
        sys.exit(f"{len(rows)} rows fit \"{spec}\", or it has no such column")
    at = names.index(column)
    value = rows[0][at]
    without_flag = value[:3] if isinstance(value, list) else value
    return cell(without_flag, table["columns"][at])


def holds(value, operator, number):
    """Whether a cell is on that side of a number."""
    low = high = value
    if isinstance(value, list):
        value, low, high = value[:3]
        low, high = (value if end is None else end for end in (low, high))
    if isinstance(value, str) or value is None:
        return operator == "=" and value == number
    limit = float(number)
    return {">": low > limit, "<": high < limit, "=": low <= limit <= high,
            "<=": low <= limit, ">=": high >= limit}[operator]


def failed_claims(text, runs):
    """A line for each claim of a document that its run does not support."""
    this = run_of(text)
    failed = []
    for spec in CLAIM.findall(text):
        machine, name, conditions, claim = parts_of(spec, this)
        column, operator, number = re.fullmatch(r"(.*) ([<>]=?|=) (.*)", claim).groups()
        table = table_of(runs, machine, name)
        names = [c["name"] for c in table["columns"]]
        if column not in names:
            sys.exit(f"table \"{name}\" has no column \"{column}\"")
        at = names.index(column)
        rows = rows_of(table, conditions)
        wrong = [cell(row[at], table["columns"][at]) for row in rows
                 if not holds(row[at], operator, number)]
        if wrong or not rows:
            failed.append(f"\"{' '.join(spec.split())}\" is not so: {', '.join(wrong) or 'no row'}")
    return failed


def filled(text, runs):
    this = run_of(text)
    text = BLOCK.sub(lambda m: m[1] + block(runs, m[2], this) + m[3], text)
    return VALUE.sub(lambda m: m[1] + single(runs, m[2], this) + m[3], text)


def page(runs):
    """docs/results.md: which runs there are."""
    text = ("# Results\n\n`scripts/results.py` makes this page from the runs in "
            "[bench/results](../bench/results). The figures of the other pages come from these "
            "runs. [The tool](cpuinfo-bench.md) measures them, and draws them as pages of all "
            "their tables. There is one run for each CPU. It shows the library of its date, "
            "which can be older than that of another run.\n\n"
            "| run | machine | halfspace | sections |\n|---|---|---|---|\n")
    for name, run in runs.items():
        context = run["context"]
        added = {name for key in context if key.startswith("also ")
                 for name in key.removeprefix("also ").split(", ")}
        sections = list(dict.fromkeys(table["name"].split(":")[0] for table in run["tables"]
                                      if table["name"] not in added))
        version = ", ".join(filter(None, [
            context["version"], context.get("commit", ""), context["date"][:10]]))
        text += (f"| `{name}.json` | {context['cpu']}, "
                 f"{context['model']}; {context['caches']}; {context['cores']} cores, "
                 f"{context['machine']}; best target {context['target']}"
                 f"{'; ' * ('noise' in context)}{context.get('noise', '')} | {version} | "
                 f"{', '.join(sections)}: `{context['command']}` |\n")
        for key, value in context.items():
            if key.startswith("also"):
                text += f"| | | {value} | {key.removeprefix('also ')} |\n"
    return text


def stored(main, others):
    """A run with the tables of others, by name."""
    def command_of(context):  # without folders
        return re.sub(r"(--out|--mesh|--bounds) \S*/", r"\1 ", context["command"])

    run = json.loads(json.dumps(main))
    run["context"]["command"] = command_of(run["context"])
    names = {table["name"] for table in run["tables"]}
    for name, other in others:
        context = other["context"]
        added = []
        for table in other["tables"]:
            full = f"{table['name']}: {name}" if name else table["name"]
            if full not in names:
                names.add(full)
                added.append(full)
                run["tables"].append({**table, "name": full})
        if added:
            run["context"][f"also {name or ', '.join(added)}"] = (
                f"{context['version']}, {context['date'][:10]}: `{command_of(context)}`")
    run["tables"] = json.loads(  # without folders, which also stand in notes and rows
        re.sub(r'[^\s"]*/([^\s"/]+\.(?:obj|csv))', r"\1", json.dumps(run["tables"])))
    for table in run["tables"]:
        if table["name"] == "broad_phase":  # more than 1000 rows
            by = [column["name"] for column in table["columns"]].index("by")
            what = [column["name"] for column in table["columns"]].index("what")
            table["rows"] = [row for row in table["rows"]
                             if row[by] == "halfspace" and row[what].startswith("frame")]
    return run


def store(machine, path, others):
    named = [other.split("=", 1) for other in others]
    run = stored(json.loads(pathlib.Path(path).read_text()),
                 [(name, json.loads(pathlib.Path(file).read_text())) for name, file in named])
    if "commit" not in run["context"] and ROOT not in pathlib.Path(path).resolve().parents:
        run["context"]["commit"] = subprocess.run(
            ["git", "-C", ROOT, "describe", "--always", "--dirty"], check=True,
            capture_output=True, text=True).stdout.strip()

    def compact(value):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))

    # A row on each line, as cpuinfo-bench writes them.
    tables = [compact({**table, "rows": []}).removesuffix("[]}") + "[\n" +
              ",\n".join(map(compact, table["rows"])) + "]}"
              for table in ({key: table[key] for key in sorted(table, key="rows".__eq__)}
                            for table in run["tables"])]
    (ROOT / f"bench/results/{machine}.json").write_text(
        f'{{"schema":{run["schema"]},\n"context":'
        + json.dumps(run["context"], indent=1, ensure_ascii=False)
        + ',\n"tables":[\n' + ",\n".join(tables) + "]}\n")


def main():
    arguments = sys.argv[1:]
    if arguments[:1] == ["--store"] and len(arguments) >= 3:
        return store(*arguments[1:3], arguments[3:])
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    paths = sorted((ROOT / "bench/results").glob("*.json"))
    runs = {path.stem: json.loads(path.read_text()) for path in paths}
    made = {ROOT / "docs/results.md": page(runs)}
    for document in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]:
        if document not in made:
            made[document] = filled(document.read_text(), runs)
    failed = []
    for document, text in made.items():
        name = document.relative_to(ROOT)
        failed += [f"{name}: {claim}" for claim in failed_claims(text, runs)]
        if document.exists() and document.read_text() == text:
            continue
        if arguments:
            sys.exit(f"{name} is not what the runs in bench/results say: run scripts/results.py")
        document.write_text(text)
    sys.exit("\n".join(failed) if failed else 0)


if __name__ == "__main__":
    main()
