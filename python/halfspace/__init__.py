"""SIMD spatial index of boxes: overlaps, joins, nearest objects and ray casts.

    import halfspace as hs

    tree = hs.BVH(boxes)                       # (n, 6) or (n, 4)
    rows, ids = tree.query(boxes2)             # which boxes overlap which
    ids, distances = tree.nearest(points, k=8)
    i, j = hs.join(tree, hs.BVH(boxes2))
"""

from ._bvh import BVH, join
from ._halfspace import version as __version__

__all__ = ["BVH", "join"]

# Where users import them from, and what they see in messages and pickles.
for _name in __all__:
    globals()[_name].__module__ = __name__
del _name
