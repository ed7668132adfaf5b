"""The report of a measurement in Python: tables as text, and as the JSON that
docs/report.schema.json describes and scripts/results.py reads."""

import argparse
import datetime
import json
import pathlib
import platform
import re
import subprocess
import sys
import time
from statistics import median  # noqa: F401, for users of this module

import numpy as np

import halfspace as hs

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from results import markdown  # noqa: E402


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


def show(tables, out, seed, repetitions):
    """Prints the tables, and writes them to the file `out`, if there is one."""
    progress("")
    for each in tables:
        print(f"\n{each['title']}\n\n{markdown(each, each['rows'])}")
        print(*each["notes"], sep="\n")
    if out:
        run = {"schema": 4, "context": context(seed, repetitions), "tables": tables}
        pathlib.Path(out).write_text(json.dumps(run, ensure_ascii=False), encoding="utf-8")
