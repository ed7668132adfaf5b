"""The report of a measurement in Python: tables as text, and as the JSON that
docs/report.schema.json describes and scripts/results.py reads."""

import argparse
import datetime
import json
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import time

import numpy as np

import halfspace as hs


def parser(description):
    """The options of a measurement: `--out`, and those that the caller adds."""
    made = argparse.ArgumentParser(description=description,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--out", help="also write the tables here, as JSON")
    return made


def seconds(call, clock=time.perf_counter):
    """The time of a call, and its result, whose end takes no time here."""
    begin = clock()
    result = call()
    return clock() - begin, result


def progress(text):
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def spread(values, digits=6):
    """A cell: the median, and the quartiles."""
    low, middle, high = np.percentile(values, (25, 50, 75))
    return [round(float(v), digits) for v in (middle, low, high)]


def ratios(over, under):
    """A cell: the median of the ratios of runs that took turns."""
    return spread([a / b for a, b in zip(over, under)], 4)


def median(values):
    return statistics.median(values)


def column(name, unit=None, digits=2, **more):
    return {"name": name, "digits": digits, **({"unit": unit} if unit else {}), **more}


def table(name, title, columns, rows, notes=()):
    return {"name": name, "title": title, "columns": columns, "rows": rows,
            "notes": list(notes)}


def context(seed, repetitions):
    text = pathlib.Path("/proc/cpuinfo").read_text()

    def field(name):
        match = re.search(rf"^{name}\s*: (.*)$", text, re.M)
        return match[1] if match else "unknown"

    caches = subprocess.run(["lscpu"], capture_output=True, text=True, check=True,
                            env={"LC_ALL": "C", "PATH": "/usr/bin:/bin"}).stdout
    caches = ", ".join(f"{level} {' '.join(size.split()[:2])}" for level, size in
                       re.findall(r"^(L[123]d?) cache:\s+(.*)$", caches, re.M))
    return {
        "version": hs.__version__,
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%MZ"),
        "command": " ".join([pathlib.Path(sys.argv[0]).name, *sys.argv[1:]]),
        "scope": "python",
        "seed": str(seed),
        "repetitions": str(repetitions),
        "cpu": field("model name"),
        "model": f"{field('vendor_id')} family {field('cpu family')} model {field('model')}",
        "caches": caches,
        "cores": str(text.count("processor\t")),
        "machine": "virtual" if "hypervisor" in text else "physical",
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "compiler": "that of the module",
        "flags": f"Python {platform.python_version()}, numpy {np.__version__}",
        "highway": "that of the module",
        "target": hs.targets()[0],
    }


def _text(value, digits):
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:,.{digits}f}".replace(",", " ")


def _cell(value, one):
    digits = one["digits"]
    if not isinstance(value, list):
        return _text(value, digits)
    middle, low, high = value[:3]
    return f"{_text(middle, digits)} [{_text(low, digits)}, {_text(high, digits)}]"


def show(tables, out, seed, repetitions):
    """Prints the tables, and writes them to the file `out`, if there is one."""
    progress("")
    for each in tables:
        head = [c["name"] + (f", {c['unit']}" if "unit" in c else "") for c in each["columns"]]
        lines = [head] + [list(map(_cell, row, each["columns"])) for row in each["rows"]]
        widths = [max(map(len, some)) for some in zip(*lines)]
        print(f"\n{each['title']}\n")
        for line in lines:
            print("  ".join(text.ljust(width) for text, width in zip(line, widths)).rstrip())
        for note in each["notes"]:
            print(note)
    if out:
        _write(out, tables, seed, repetitions)


def _write(path, tables, seed, repetitions):
    def compact(value):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))

    # A row on each line, as cpuinfo-bench writes them.
    texts = []
    for each in tables:
        head = {key: value for key, value in each.items() if key != "rows"}
        texts.append(f'{compact(head)[:-1]},"rows":[\n'
                     + ",\n".join(map(compact, each["rows"])) + "]}")
    run = json.dumps(context(seed, repetitions), indent=1, ensure_ascii=False)
    pathlib.Path(path).write_text(
        f'{{"schema":4,\n"context":{run},\n"tables":[\n' + ",\n".join(texts) + "]}\n",
        encoding="utf-8")
