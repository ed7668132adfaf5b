"""What an installed wheel must do, on every target that the machine has."""

import os
import subprocess
import sys

import halfspace

for target in halfspace.targets():
    code = "import halfspace; print(halfspace.BVH([[0, 0, 2, 2]]).query([1, 1, 3, 3]))"
    ids = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "HALFSPACE_TARGET": target},
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()
    if ids != "[0]":
        sys.exit(f"{target}: a query returned {ids}")
print(" ".join(halfspace.targets()))
