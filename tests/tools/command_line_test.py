#!/usr/bin/env python3
"""command_line_test.py messages|runs FOLDER COMMAND...: cpuinfo-bench as its users call it: exit
codes and messages. FOLDER is for files, and `runs` has the cases that measure something."""

import os
import pathlib
import re
import shlex
import subprocess
import sys

group, folder, command = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
is_emulated = len(command) > 1
folder.mkdir(parents=True, exist_ok=True)
(folder / "folder").mkdir(exist_ok=True)
(folder / "link").unlink(missing_ok=True)
(folder / "link").symlink_to(folder / "out")
FILES = {
    "quad.obj": "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
    "bad.obj": "v 0 0 0\nv 1 0 0\nv 1 1 zero\nf 1 2 3\n",
    "boxes.csv": "0,0,0,1,1,1\n2,2,2,3,3,3\n",
    "queries.csv": "0,0,0,1,1,1\n5,5,5,6,6,6\n",
    "far.obj": "v 3e38 0 0\nv 0 3e38 0\nv 0 0 3e38\nf 1 2 3\n",
    "far.csv": "2e38,2e38,2e38,3e38,3e38,3e38\n",
    "bad.csv": "0,0,0,1,1,1\n0,0,0,nan,1,1\n"}
for name, content in FILES.items():
    (folder / name).write_text(content)
KEPT = "^what was there$"
MACHINE = "--details machine "

# Arguments, exit code, and what stdout, stderr and the file of --out match. With `out` there is a
# file "out" before. {0} is the folder.
MESSAGES = [
    ("--version", 0, {"stdout": r"^cpuinfo-bench \d"}),
    ("--help", 0, {"stdout": "--mesh"}),
    ("--list", 0, {"stdout": "^verdict\nanswers\n(.*\n)*noise\n$"}),
    ("--details machine,quality --objects 4096", 0,
     {"stderr": r"^cpuinfo-bench: machine +0 %\ncpuinfo-bench: quality +9 %\n$"}),
    ("--fast", 2, {"stderr": "--fast"}),
    ("--details speed", 2, {"stderr": "speed"}),
    ("--target MMX", 2, {"stderr": "MMX not in .*SCALAR"}),
    ("--mesh a.obj --bounds b.csv", 2, {"stderr": "excludes"}),
    ("--mesh a.obj --query-bounds b.csv --query-size 1", 2, {"stderr": "excludes"}),
    (MACHINE + "--query-size 1", 2, {"stderr": "give --mesh or --bounds"}),
    ("--repetitions 0", 2, {"stderr": "repetitions"}),
    (MACHINE + "--out {0}/none/x", 2, {"stderr": "cannot be written"}),
    ("--details quality --mesh {0}/quad.obj", 0, {"stdout": "2 objects, 2 queries"}),
    ("--details machine,quality --bounds {0}/boxes.csv", 0, {"stdout": r"AABB +2 +1\.00"}),
    # Of the two boxes, the first is touched by one of both queries.
    ("--details quality --bounds {0}/boxes.csv --query-bounds {0}/queries.csv", 0,
     {"stdout": r"AABB +1 +0\.50 +1\.00(.*\n)*.*2 objects, 2 queries"}),
    ("--details quality --bounds {0}/boxes.csv --query-size 100 --queries 3", 0,
     {"stdout": r"AABB +6 +2\.00 +1\.00(.*\n)*.*2 objects, 3 queries"}),
    ("--details quality --bounds {0}/boxes.csv --query-bounds {0}/bad.csv", 3,
     {"stderr": "bad.csv:2: "}),
    ("--details quality --mesh {0}/bad.obj", 3, {"stderr": "bad.obj:3: "}),
    ("--details quality --bounds {0}/bad.csv", 3, {"stderr": "bad.csv:2: "}),
    ("--mesh {0}/none.obj", 3, {"stderr": "none.obj: "}),
    ("--details quality --mesh {0}/far.obj", 3, {"stderr": "Everything"}),
    ("--details quality --bounds {0}/far.csv", 3, {"stderr": "Everything"}),
    (MACHINE + "--target SCALAR", 0, {"stdout": "chosen +scalar, which"}),
    # Files that are read are not written, whatever they are called.
    ("--mesh {0}/../{1}/out --out {0}/out", 2, {"out": KEPT, "stderr":
     "--out .* would overwrite the file of --mesh .*; name another"}),
    ("--mesh {0}/link --out {0}/folder/../out", 2, {"out": KEPT, "stderr":
     "--out .* would overwrite the file of --mesh .*link; name another"}),
    ("--bounds {0}/./out --out {0}/out", 2, {"out": KEPT, "stderr":
     "--out .* would overwrite the file of --bounds .*; name another"}),
    ("--bounds {0}/boxes.csv --query-bounds {0}/out --out {0}/out", 2, {"out": KEPT, "stderr":
     "would overwrite the file of --query-bounds .*; name another"}),
    ("--details machine,quality --objects 4096 --queries 2 --format json", 0,
     {"stdout": '"name":"quality"'}),
    # Every message of a bad environment reaches the user too.
    (MACHINE, 2, {"stderr": "HALFSPACE_TARGET.*MMX", "env": {"HALFSPACE_TARGET": "MMX"}}),
    (MACHINE, 2, {"stderr": "x1bc", "env": {"HALFSPACE_TARGET": "\x1bc"}}),
    ("--mesh '\x1b[31m'", 3, {"stderr": r"x1b\[31m: "}),
    ("--details quality --objects 64 --quick --seed 010", 0, {"stdout": "; seed 10; "}),
    ("--details quality --objects 1.5e3 --queries 1e0 --seed 1e6", 0,
     {"stdout": "1 500 objects, 1 queries"}),
    (MACHINE + "--out {0}/out", 0, {"out":
     r"^cpuinfo-bench [0-9.]+ --details machine.*; seed 1; [^\n]*\n[^\n]*\n\nmachine: "}),
    (MACHINE + "--mesh {0}/none.obj --out {0}/out", 3, {"out": KEPT}),
    (MACHINE + "--objects 1073741824", 0, {}),
    ("--details quality --objects 8388608", 2, {"before": ["prlimit", "--as=200000000"],
     "stdout": "^$", "stderr": "256 MiB.*fewer --objects"}),
]
MESSAGES += [(f"--bounds b.csv --query-size {size}", 2, {"stderr": "not a number above 0"})
             for size in ("0", "-1", "101", "nan", "1x")]
MESSAGES += [(f"{MACHINE}--exact-ns {ns}", 2, {"stderr": "not a number above 0"})
             for ns in ("nan", "0", "-1", "1x")]
MESSAGES += [(f"{MACHINE}--seed {seed}", 2, {"stderr": "not a whole number from 0 to"})
             for seed in ("-1", "18446744073709551616", "0x10", "1e16", "0.5", "''")]
MESSAGES += [(f"{MACHINE}{option} ''", 2, {"stderr": "empty file name"})
             for option in ("--mesh", "--bounds", "--out")]
MESSAGES += [(f"--details '{sections}'", 2, {"stderr": "not a section"})
             for sections in ("quality,check", "")]
if os.path.exists("/dev/full"):
    MESSAGES += [(arguments, 4, {"to": "/dev/full", "stderr": "standard output"})
                 for arguments in ("--list", "--help", "--version", MACHINE)]
    MESSAGES += [(MACHINE + "--out /dev/full", 4, {"stderr": "/dev/full: "})]
# 32 GiB, where that cannot be had; the machine is told first.
if (memory := pathlib.Path("/proc/meminfo")).exists():
    if int(re.search(r"MemAvailable: +(\d+)", memory.read_text())[1]) < 30_000_000:
        MESSAGES += [("--objects 1073741824", 2, {"stderr": "32768 MiB.*fewer --objects"})]

RUNS = [
    # Whether the run is noisy, nobody knows; that it is asked, the report tells.
    ("--strict --quick --details machine --objects 4096", (0, 4),
     {"stdout": "a kernel timed against itself"}),
    # The page begins with the verdict, and fits 80 columns and 100 lines. In little memory:
    # page.run measures the world of 4 GiB.
    ("--quick --objects 4096 --queries 8 --repetitions 1", 0,
     {"before": ["prlimit", "--as=1900000000"], "lines": 100, "width": 80,
      "stdout": r"^The simplex scan is faster[^\n]*\n  (.*\n)+If each kept object costs an exact test of (.*\n)+"
                r"cpuinfo-bench (.*\n)+verdict: (.*\n)+answers: "}),
    # One target that programs would not get.
    ("--quick --objects 4096 --queries 4 --repetitions 1 --target SCALAR "
     "--details verdict,answers", 0, {"stdout": r"The simplex scan is faster[^\n]*\n  scalar  "}),
    # A file has one world.
    ("--details verdict --quick --repetitions 1 --bounds {0}/boxes.csv", 0,
     {"stdout": r"\nThe box scan takes so many times [^\n]*:\n  (.*\n)+ +file +(.*\n)+"
                r"  The file has 2 objects(.*\n)+.*with\s+2\s+different\s+queries"}),
    ("--details kernels --objects 4096 --out {0}/out", 124,
     {"before": ["timeout", "1"], "out": KEPT}),
]


def problem_of(arguments, code, expected):
    """What is wrong with a run; None if nothing is."""
    out = folder / "out"
    out.write_text("what was there")
    words = [word.format(folder, folder.name) for word in shlex.split(arguments)]
    to = open(expected["to"], "w") if "to" in expected else subprocess.PIPE
    run = subprocess.run([*expected.get("before", []), *command, *words], stdout=to,
                         stderr=subprocess.PIPE, encoding="utf-8", errors="replace",
                         env={**os.environ, **expected.get("env", {})})
    found = {"stdout": run.stdout or "", "stderr": run.stderr, "out": out.read_text()}
    codes = code if isinstance(code, tuple) else (code,)
    if run.returncode not in codes:
        return f"exit code {run.returncode}, not {codes}", found
    for stream, text in found.items():
        if not re.search(expected.get(stream, ""), text):
            return f"{stream} does not match {expected[stream]!r}", found
    lines = found["stdout"].split("\n")
    if len(lines) - 1 > expected.get("lines", 1000):
        return "too many lines", found
    # Except the one that repeats the command.
    widest = max(len(line) for line in lines if not line.startswith("cpuinfo-bench "))
    if widest > expected.get("width", 1000):
        return "a line is too long", found
    # Without a terminal, a line for each section, and no escape sequences.
    rest = re.sub(r"cpuinfo-bench: [a-z0-9_]+( [a-z0-9_]+)* +[0-9]+ %\n", "", run.stderr)
    # An error of the tool's own is one line, whatever is in it.
    if 0 < run.returncode < 10 and not re.fullmatch(r"cpuinfo-bench: [^\n\x1b]+\n", rest):
        return "not one line, of this program", found
    if run.returncode == 0 and rest:
        return "a successful run wrote to stderr", found
    return None


failed = 0
for row in {"messages": MESSAGES, "runs": RUNS}[group]:
    if is_emulated and "before" in row[2]:
        continue
    problem = problem_of(*row)
    if problem:
        failed += 1
        print(f"{row[0]}: {problem[0]}\n" + "\n".join(f"  {k}: {v}" for k, v in problem[1].items()))
sys.exit(f"{failed} runs failed" if failed else 0)
