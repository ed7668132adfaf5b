#!/usr/bin/env python3
"""Runs the code of docs/python.md, block after block, and draws its figures, each from the names
of the code so far. Compares what the code prints, and the figures, with the page.

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

matplotlib = pytest.importorskip("matplotlib", reason="needs python3-matplotlib")
pytest.importorskip("geopandas", reason="needs python3-geopandas")
pytest.importorskip("shapely", reason="needs python3-shapely")
matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.image import imread  # noqa: E402

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"
# A block of code, and the block of text that it prints.
BLOCK = re.compile(r"^```python\n(.*?)^```\n(?:```text\n.*?^```\n)?", re.M | re.S)
FIGURE = re.compile(r"!\[[^]]+\]\(python-(\w+)\.png\)")
STEP = re.compile(f"{BLOCK.pattern}|{FIGURE.pattern}", re.M | re.S)
UNIT = {"aspect": "equal", "xlim": (0, 1), "ylim": (0, 1)}


def draw_polygons(axes, polygons, **style):
    for polygon in polygons:
        for part in getattr(polygon, "geoms", [polygon]):
            axes.fill(*part.exterior.xy, **style)


def join(names):
    ids, fields = names["ids"], names["fields"]
    crossed = set(ids[names["crosses"]])
    rejected = set(ids) - crossed
    figure, axes = plt.subplots(figsize=(5.6, 5.6), layout="constrained")
    draw_polygons(axes, fields, color="#e4e4e4")
    draw_polygons(axes, [fields[i] for i in rejected], color="#f0c070")
    draw_polygons(axes, [fields[i] for i in crossed], color="#5a9a5a")
    draw_polygons(axes, names["rivers"], color="#2060a0")
    axes.set(**UNIT, xlabel="x", ylabel="y",
             title="green: crossed by a river, yellow: only a candidate")
    return figure


def nearest(names):
    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    for x_min, y_min, x_max, y_max in names["buildings"]:
        axes.fill([x_min, x_max, x_max, x_min], [y_min, y_min, y_max, y_max], color="#c8c8c8")
    for well, ends, found in zip(names["wells"], names["nearest_points"], names["inside"]):
        for end in ends[found]:
            axes.plot(*np.stack([well, end], axis=1), color="#c04020", linewidth=1.5)
    axes.plot(*names["wells"].T, "o", color="#2060a0", markersize=5)
    axes.set(**UNIT, xlabel="x", ylabel="y",
             title="the 4 buildings nearest to each well, up to 0.04 away")
    return figure


def rays(names):
    depth = names["depth"]
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    picture = np.where(np.isfinite(depth), depth, np.nan)
    image = axes.imshow(picture.reshape(names["height"], names["width"]), cmap="viridis_r")
    axes.set(title="depth of the first hit", xticks=[], yticks=[])
    figure.colorbar(image, label="t")
    return figure


def bodies(names):
    radii, collide = names["radii"], names["collide"]
    hitting = np.zeros(names["count"], bool)
    hitting[names["i"][collide]] = hitting[names["j"][collide]] = True
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.4), layout="constrained")
    left.add_collection(EllipseCollection(
        2 * radii, 2 * radii, np.zeros(len(radii)), units="xy", offsets=names["places"],
        offset_transform=left.transData, facecolors=np.where(hitting, "#c04020", "#c8c8c8")))
    left.set(**UNIT, title="the last frame; red: collides")
    right.plot(names["candidates"], label="candidates", color="#2060a0")
    right.plot(names["collisions"], label="collisions", color="#c04020")
    right.set(xlabel="frame", ylabel="pairs", ylim=(0, None), title="pairs in each frame")
    right.legend()
    return figure


def run(text, directory):
    """Runs the blocks and draws the figures in `directory`. Returns the text with what the blocks
    print."""
    names = {"__name__": "tutorial"}

    def run_step(match):
        if match[2]:
            draw = {"join": join, "nearest": nearest, "rays": rays, "bodies": bodies}[match[2]]
            draw(names).savefig(f"python-{match[2]}.png", dpi=80)
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
    directory = tmp_path_factory.mktemp("tutorial")
    return run(PAGE.read_text(encoding="utf-8"), directory), directory


def test_prints_what_the_page_says(tutorial):
    assert tutorial[0] == PAGE.read_text(encoding="utf-8")


def test_draws_the_figures_of_the_page(tutorial):
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
    from PIL import Image

    with tempfile.TemporaryDirectory() as directory:
        text = run(PAGE.read_text(encoding="utf-8"), directory)
        for path in pathlib.Path(directory).glob("*.png"):
            # A palette makes the files half as large.
            picture = Image.open(path).convert("RGB").quantize(128)
            picture.save(PAGE.parent / path.name, optimize=True)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
