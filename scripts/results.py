#!/usr/bin/env python3
"""Writes docs/results.md, and the figures in README.md and docs/*.md that come from the
stored runs in bench/results/*.json. Then checks the sentences that docs/figures.txt has claims for.

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

A block in a page, whose lines this replaces with a table of a run:

    <!-- results: <machine> | <table> [| <column>=<value>,..., notes or lead] -->
    <!-- end of results -->

The keys of single figures and of claims are in docs/figures.txt. An entry is a line of words
that the page has once, with {} for each figure, and the keys of the entry. Line breaks of the
page do not matter:

    [README.md]
    keeps {} times as many objects
        value: <machine> | <table> | <column>=<value>,... | <column>
        claim: <machine> | <table> | <column>=<value>,... | <column> > 1

This replaces the first {} by the first value, and so on. A value is the cell of the one row
that fits. A claim must hold in all rows that fit, at least one. With a range, > and < are true
if the whole range is on that side, and >= and <= if a part of it is. = is true if the number is
in the range, or if the cell has this text.

In a page with <!-- run: <machine> -->, "@" is that machine.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FIGURES = "docs/figures.txt"
BLOCK = re.compile(
    r"(<!-- results: (.*?) -->\n)(?:(?!<!-- results:).)*?(<!-- end of results -->)", re.S)
RUN = re.compile(r"<!-- run: (\S+) -->")
NUMBER = r"-?\d{1,3}(?:\s\d{3})*(?:\.\d+)?"
RANGE = rf"{NUMBER}\s\[{NUMBER},\s{NUMBER}\]"


class Wrong(Exception):
    """What is wrong with a key, or with the words that it is for, and what to do."""


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
        raise Wrong(f"bench/results/{machine}.json is missing: correct the key")
    for table in runs[machine]["tables"]:
        if table["name"] == name:
            return table
    raise Wrong(f"bench/results/{machine}.json has no table \"{name}\": correct the key, or "
                "remove it with its words")


def column_of(table, name):
    names = [column["name"] for column in table["columns"]]
    if name not in names:
        raise Wrong(f"table \"{table['name']}\" has no column \"{name}\": correct the key")
    return names.index(name)


def rows_of(table, conditions):
    """The rows whose cells are as `column=value,...` says."""
    rows = table["rows"]
    for condition in filter(None, re.split(r",(?=[^,=]+=)", conditions)):
        name, value = condition.strip().split("=", 1)
        at = column_of(table, name)
        rows = [row for row in rows if cell(row[at], table["columns"][at]) == value]
    return rows


def parts_of(spec, this, count):
    """The parts of a key, with the run of its page in place of "@"."""
    machine, *parts = (" ".join(part.split()) for part in spec.split("|"))
    if len(parts) not in count:
        raise Wrong(f"\"{spec}\" has {len(parts) + 1} parts: see scripts/results.py --help")
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
    machine, name, *conditions = parts_of(spec, this, {1, 2})
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
    machine, name, conditions, column = parts_of(spec, this, {3})
    table = table_of(runs, machine, name)
    at = column_of(table, column)
    rows = rows_of(table, conditions)
    if len(rows) != 1:
        raise Wrong(f"{len(rows)} rows fit \"{spec}\", not one: correct the key")
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


def check_claim(runs, spec, this):
    machine, name, conditions, claim = parts_of(spec, this, {3})
    parts = re.fullmatch(r"(.*) ([<>]=?|=) (.*)", claim)
    if not parts:
        raise Wrong(f"\"{claim}\" compares nothing: see scripts/results.py --help")
    column, operator, number = parts.groups()
    table = table_of(runs, machine, name)
    at = column_of(table, column)
    rows = rows_of(table, conditions)
    wrong = [cell(row[at], table["columns"][at]) for row in rows
             if not holds(row[at], operator, number)]
    if wrong or not rows:
        raise Wrong(f"\"{spec}\" is not so: {', '.join(wrong) or 'no row'}. "
                    "Correct the sentence, or the key")


def entries_of(text):
    """The entries of docs/figures.txt by page: the number of the line, the words, and the keys
    with the numbers of their lines."""
    pages = {}
    for at, line in enumerate(text.splitlines(), 1):
        page = re.fullmatch(r"\[(\S+)\]", line)
        key = re.fullmatch(r"\s+(value|claim): (.*)", line)
        if page:
            entries = pages.setdefault(page[1], [])
        elif key and pages and entries:
            entries[-1][2].append((at, key[1], key[2]))
        elif line and not line[0].isspace() and pages:
            entries.append((at, line, []))
        elif line:
            sys.exit(f"{FIGURES}:{at}: is no page, no words and no key: "
                     "see scripts/results.py --help")
    return pages


def line_at(text, at):
    return text.count("\n", 0, at) + 1


def place_of(page, text, words):
    """Where a page has the words of an entry."""
    parts = [r"\s+".join(map(re.escape, re.split(r"\s+", part))) for part in words.split("{}")]
    places = list(re.finditer(r"(?<![\w.])" + f"({RANGE}|{NUMBER})".join(parts) + r"(?!\w)", text))
    if len(places) == 1:
        return places[0]
    if places:
        lines = " and ".join(str(line_at(text, place.start())) for place in places)
        raise Wrong(f"{page} has these words in the lines {lines}: add words until one fits")
    wanted = set(words.split())
    lines = text.split("\n")
    near = max(range(len(lines)), key=lambda at: len(
        wanted.intersection(" ".join(lines[max(at - 1, 0):at + 2]).split())))
    raise Wrong(f"{page} has no such words, with a figure for each {{}}. The most similar are near "
                f"{page}:{near + 1}. Copy its words to here, or remove this entry")


def filled(page, text, entries, runs):
    """A page with the figures of its runs, and a line for each error."""
    this = run_of(text)
    errors = []

    def attempt(where, what, *arguments):
        try:
            return what(*arguments)
        except Wrong as wrong:
            errors.append(f"{where}: {wrong}")

    changes = {}
    for line, words, keys in entries:
        place = attempt(f"{FIGURES}:{line}", place_of, page, text, words)
        values = [key for key in keys if key[1] == "value"]
        if not keys or len(values) != words.count("{}"):
            errors.append(f"{FIGURES}:{line}: has {words.count('{}')} times {{}} and {len(values)} "
                          f"values of {len(keys)} keys: add what is missing")
        elif place:
            for at, (line, _, spec) in enumerate(values, 1):
                if place.span(at) in changes:
                    errors.append(f"{FIGURES}:{line}: {page}:{line_at(text, place.start(at))} "
                                  "has this figure from another key, too: remove one")
                value = attempt(f"{FIGURES}:{line}", single, runs, spec, this)
                is_same = " ".join(place[at].split()) == value  # lines may break in a figure
                changes[place.span(at)] = place[at] if is_same else value
        for line, kind, spec in keys:
            if kind == "claim":
                attempt(f"{FIGURES}:{line}", check_claim, runs, spec, this)
    for match in BLOCK.finditer(text):
        table = attempt(f"{page}:{line_at(text, match.start())}", block, runs, match[2], this)
        changes[match.span()] = table and match[1] + table + match[3]

    for match in re.finditer(rf"{RANGE}|<!--(?! run: \S+ -->)", text):
        if not any(start <= match.start() < end for start, end in changes):
            what = ("is no whole block of results" if match[0] == "<!--" else
                    f"{' '.join(match[0].split())} is a figure without a key")
            errors.append(f"{page}:{line_at(text, match.start())}: {what}: "
                          f"write the words around it and its key into {FIGURES}")
    for (start, end), new in sorted(changes.items(), reverse=True):
        text = text[:start] + (new or text[start:end]) + text[end:]
    return text, errors


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
    pages = ["README.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]
    entries = entries_of((ROOT / FIGURES).read_text())
    failed = [f"{FIGURES}: has no page {name}: correct its name, or remove its entries"
              for name in entries.keys() - {*pages}]
    for name in pages:
        before = (ROOT / name).read_text()
        if name == "docs/results.md":
            after = page(runs)
        else:
            after, errors = filled(name, before, entries.get(name, []), runs)
            failed += errors
        if before == after:
            continue
        if arguments:
            lines = zip(before.split("\n"), after.split("\n"))
            at = next((at for at, (old, new) in enumerate(lines, 1) if old != new), 1)
            failed.append(f"{name}:{at}: is not what the runs in bench/results say: "
                          "run scripts/results.py")
        else:
            (ROOT / name).write_text(after)
    sys.exit("\n".join(failed) if failed else 0)


if __name__ == "__main__":
    main()
