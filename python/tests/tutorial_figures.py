"""Draws the figures of docs/python.md, each from the names of the tutorial's code so far."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection

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


def draw(name, names):
    """Writes python-<name>.png into the current folder."""
    drawer = {"join": join, "nearest": nearest, "rays": rays, "bodies": bodies}[name]
    drawer(names).savefig(f"python-{name}.png", dpi=80)
