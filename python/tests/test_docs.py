"""The examples of the docstrings, and the type hints."""

import doctest
import inspect
import os
import pathlib
import re
import subprocess
import sys

import halfspace as hs
import pytest


def test_examples():
    finder, runner = doctest.DocTestFinder(), doctest.DocTestRunner()
    for thing in (hs._searches.Searches, *(getattr(hs, name) for name in hs.__all__)):
        for test in finder.find(thing, module=False):  # True leaves out methods
            runner.run(test)
    assert runner.tries > 20 and runner.failures == 0


def test_the_program_of_the_readme():
    readme = pathlib.Path(__file__).parents[2] / "README.md"
    program = re.search(r"```python\n(.*?)```", readme.read_text(), re.S)[1]
    names = {}
    exec(program, names)
    assert (names["rows"].tolist(), names["ids"].tolist()) == ([0], [0])
    assert names["distances"].tolist() == [[2]]
    assert len(names["i"]) == 0


def test_each_program_of_the_page_on_clusters(tmp_path):
    pytest.importorskip("distributed")
    pytest.importorskip("pandas")
    page = pathlib.Path(__file__).parents[2] / "docs" / "scale.md"
    programs = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
    for program in programs:
        (tmp_path / "program.py").write_text(program)
        subprocess.run([sys.executable, "program.py"], cwd=tmp_path, check=True)
    assert len(programs) == 2 and len(list((tmp_path / "pairs").iterdir())) > 0


def test_every_public_name_has_a_docstring():
    for name in hs.__all__:
        thing = getattr(hs, name)
        assert thing.__doc__, name
        if inspect.isclass(thing):
            for key, member in inspect.getmembers(thing):
                if not key.startswith("_"):
                    assert inspect.getdoc(member), f"{name}.{key}"


def test_types(tmp_path):
    pytest.importorskip("mypy")
    package = os.path.dirname(hs.__file__)
    # mypy finds a package in site-packages, and refuses to be told of it.
    paths = "" if "site-packages" in package else os.path.dirname(package)

    def mypy(*arguments):
        return subprocess.run([sys.executable, "-m", "mypy", "--no-incremental", *arguments],
                              cwd=tmp_path, env={**os.environ, "MYPYPATH": paths},
                              capture_output=True, text=True)

    (tmp_path / "user.py").write_text(
        "import halfspace as hs\n"
        "tree = hs.BVH([[0, 0, 1, 1]])\n"
        "rows, ids = tree.query([[0, 0, 1, 1]], threads=None)\n"
        "ids, distances = tree.nearest([0, 0], k=2)\n"
        "reveal_type(hs.join(tree, tree))\n"
        "reveal_type(tree.raycast(ids, ids, all_hits=True)[1])\n"
        "reveal_type(tree.count([0, 0, 1, 1]))\n"
        "reveal_type(tree.insert([[0, 0, 1, 1]]))\n"
        "hs.Scan(tree, quantised=True)\n"
    )
    run = mypy("--strict", "user.py")
    lines = run.stdout.splitlines()
    expected = ["numpy.ndarray", "numpy.ndarray", "builtins.int", "numpy.ndarray"]
    for line, kind in zip(lines, expected):
        assert f'Revealed type is "{kind}' in line, run.stdout
    assert "quantised" in lines[4], run.stdout
    assert lines[-1].startswith("Found 1 error in 1 file"), run.stdout
    run = mypy(package)
    assert run.returncode == 0, run.stdout
