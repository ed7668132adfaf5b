#!/usr/bin/env python3
"""Runs the code of docs/python.md, block after block, and compares what it prints with the page.

`python3 python/tests/test_tutorial.py` writes the figures and the printed results into docs.
"""

import contextlib
import io
import os
import pathlib
import re
import tempfile

import numpy as np
import pytest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"
# A block of code, and the block of text that it prints.
BLOCK = re.compile(r"^```python\n(.*?)^```\n(?:```text\n.*?^```\n)?", re.M | re.S)
FIGURE = re.compile(r"!\[[^]]+\]\(python-(\w+)\.png\)")
STEP = re.compile(f"{BLOCK.pattern}|{FIGURE.pattern}", re.M | re.S)


def run(text, directory):
    """Runs the blocks and draws the figures in `directory`. Returns the text with what the blocks
    print."""
    import tutorial_figures

    names = {"__name__": "tutorial"}

    def run_step(match):
        if match[2]:
            tutorial_figures.draw(match[2], names)
            return match[0]
        # Line numbers are those of the page, so that a traceback shows its lines.
        code = "\n" * text.count("\n", 0, match.start(1)) + match[1]
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(code, str(PAGE), "exec"), names)
        printed = output.getvalue()
        return f"```python\n{match[1]}```\n" + (f"```text\n{printed}```\n" if printed else "")

    old = os.getcwd()
    os.chdir(directory)
    try:
        return STEP.sub(run_step, text)
    finally:
        os.chdir(old)


@pytest.fixture(scope="module")
def tutorial(tmp_path_factory):
    matplotlib = pytest.importorskip("matplotlib", reason="needs python3-matplotlib")
    pytest.importorskip("shapely", reason="needs python3-shapely")
    matplotlib.use("Agg")
    directory = tmp_path_factory.mktemp("tutorial")
    return run(PAGE.read_text(encoding="utf-8"), directory), directory


def test_prints_what_the_page_says(tutorial):
    assert tutorial[0] == PAGE.read_text(encoding="utf-8")


def test_draws_the_figures_of_the_page(tutorial):
    from matplotlib.image import imread

    text, directory = tutorial
    figures = [f"python-{name}.png" for name in FIGURE.findall(text)]
    assert sorted(figures) == sorted(path.name for path in directory.glob("*.png"))
    for figure in figures:
        drawn, stored = imread(directory / figure), imread(PAGE.parent / figure)
        assert drawn.shape[:2] == stored.shape[:2]
        # Fonts and colours differ a little from one machine to another.
        assert abs(drawn[..., :3] - stored[..., :3]).mean() < 0.05
        assert drawn[..., :3].std() > 0.05


def main():
    import matplotlib
    from PIL import Image

    matplotlib.use("Agg")
    with tempfile.TemporaryDirectory() as directory:
        text = run(PAGE.read_text(encoding="utf-8"), directory)
        for path in pathlib.Path(directory).glob("*.png"):
            # A palette makes the files half as large.
            picture = Image.open(path).convert("RGB").quantize(128)
            picture.save(PAGE.parent / path.name, optimize=True)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
