"""SIMD spatial index of boxes: overlaps, joins, nearest objects and ray casts.

    import halfspace as hs

    tree = hs.BVH(boxes)                       # (n, 6) or (n, 4)
    rows, ids = tree.query(boxes2)             # which boxes overlap which
    ids, distances = tree.nearest(points, k=8)
    i, j = hs.join(tree, hs.BVH(boxes2))

    bodies = hs.BroadPhase()                   # boxes that move in each frame
    mesh = hs.TriangleMesh(vertices, faces)    # rays and closest points
"""

from typing import List

from ._broad_phase import BroadPhase
from ._bvh import BVH, bounds_of_triangles, join
from ._halfspace import targets as _targets
from ._halfspace import version as __version__
from ._mesh import TriangleMesh
from ._scan import Scan

__all__ = ["BVH", "BroadPhase", "Scan", "TriangleMesh", "bounds_of_triangles", "join", "targets"]


def targets() -> List[str]:
    """Returns the instruction sets that halfspace can use here, the best first.

    halfspace uses the first. Set the environment variable HALFSPACE_TARGET to
    one of the names to use another.
    """
    return _targets()


# Where users import them from, and what they see in messages and pickles.
for _object in (BVH, BroadPhase, Scan, TriangleMesh, bounds_of_triangles, join):
    _object.__module__ = __name__
del _object
