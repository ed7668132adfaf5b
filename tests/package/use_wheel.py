"""What an installed wheel must say of itself, and do on every target that the machine has."""

import importlib.metadata
import os
import subprocess
import sys

import halfspace

its = importlib.metadata.metadata("halfspace")
for field, expected in (
    ("Version", halfspace.__version__),
    ("Author", "The halfspace authors"),
    ("Project-URL", "Homepage, https://halfspace.invalid"),
    ("Description-Content-Type", "text/markdown"),
):
    if its[field] != expected:
        sys.exit(f"{field}: {its[field]!r} is not {expected!r}")
if not its["Summary"] or "# halfspace" not in (its["Description"] or its.get_payload()):
    sys.exit("the wheel has no description")
if sorted(its.get_all("Provides-Extra", [])) != ["dask", "geo"]:
    sys.exit(f"the extras are {its.get_all('Provides-Extra')}")
if "License :: OSI Approved :: MIT License" not in its.get_all("Classifier", []):
    sys.exit("the classifiers do not have the license")

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
