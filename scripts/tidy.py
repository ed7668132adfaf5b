#!/usr/bin/env python3
"""Runs clang-tidy, with the checks of .clang-tidy, on the sources of the library, of
cpuinfo-bench and of the Python package that were configured for a build and contain no
kernels:

  scripts/tidy.py BUILD_DIRECTORY [FILE...]

clang's warnings are errors here, too, if it is the compiler of that build.
"""

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
IS_CHECKED = re.compile(r"(bench|c|dispatch|kernels|python)/.*\.cc")


def lists_of_files(build, names):
  """(call of the compiler, files) for each folder, and for the whole tool: the files that
  it reads alike. What several programs compile is read once."""
  lists = {}
  seen = set()
  for entry in json.loads((build / "compile_commands.json").read_text()):
    file = pathlib.Path(entry["file"])
    name = os.path.relpath(file, ROOT)
    # Kernels are the same text, target after target.
    if names:
      is_checked = name in names
    else:
      is_checked = (IS_CHECKED.fullmatch(name) and
                    "hwy/foreach_target.h" not in file.read_text())
    if not is_checked or file in seen: continue
    seen.add(file)
    call = shlex.split(entry["command"])
    call = [each for each in call[:call.index("-o")] if not each.startswith("-O")]
    # Without the precompiled headers, which only a build makes.
    if "-include-pch" in call:
      first = call.index("-include-pch") - 1
      del call[first:first + 8]
    folder = "bench" if name.startswith("bench/") else file.parent
    lists.setdefault((folder, *call), []).append(file)
  return [(call, files) for (_, *call), files in lists.items()]


def run(*command):
  return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def tidy(call, files):
  """True if nothing is found. The checks look at headers as long as at the sources, so
  all files are one source at first. If that fails, also because two files have a private
  name in common, halves of them are checked."""
  if len(files) == 1:
    checked = run("clang-tidy", "--quiet", files[0], "--", *call[1:])
    if checked.returncode != 0: print(checked.stdout, checked.stderr, sep="", flush=True)
    return checked.returncode == 0
  # Below the root, so that clang-tidy finds .clang-tidy.
  with tempfile.NamedTemporaryFile("w", dir=ROOT / "build", suffix=".cc") as source:
    source.writelines(f'#include "{file}"\n' for file in files)
    source.flush()
    if (run(*call, "-fsyntax-only", source.name).returncode == 0 and
        run("clang-tidy", "--quiet", "--checks=-bugprone-suspicious-include",
            source.name, "--", *call[1:]).returncode == 0):
      return True
  half = len(files) // 2
  return all([tidy(call, files[:half]), tidy(call, files[half:])])


def main():
  build, *names = sys.argv[1:]
  lists = lists_of_files(pathlib.Path(build), set(map(os.path.normpath, names)))
  if not lists: sys.exit("scripts/tidy.py: the build compiles none of these files")
  lists.sort(key=lambda each: -len(each[1]))
  (ROOT / "build").mkdir(exist_ok=True)
  with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    if not all(list(pool.map(lambda each: tidy(*each), lists))): sys.exit(1)


if __name__ == "__main__":
  main()
