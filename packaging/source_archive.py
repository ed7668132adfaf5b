#!/usr/bin/env python3
"""usage: packaging/source_archive.py OUT.tar.gz

Packs the committed sources of HEAD, the headers of libhwy-dev, and an SPDX list of all of them
(sbom.spdx). The archive builds without a network: CMake takes the headers from
third_party/highway (cmake/HalfspaceHighway.cmake). The same commit and headers make the
same bytes.
"""

import gzip
import hashlib
import io
import re
import subprocess
import sys
import tarfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDE = Path("/usr/include")


def git(*arguments):
    return subprocess.check_output(["git", "-C", str(ROOT), *arguments])


def sources():
    """The bytes and the mode of each committed file, by name."""
    with tarfile.open(fileobj=io.BytesIO(git("archive", "HEAD"))) as archive:
        for member in archive:
            if member.isfile():
                yield member.name, archive.extractfile(member).read(), member.mode


def headers():
    for path in sorted((INCLUDE / "hwy").rglob("*.h")):
        if path.parent.name != "tests":
            yield f"third_party/highway/{path.relative_to(INCLUDE)}", path.read_bytes(), 0o644
    yield "third_party/highway/LICENSE", Path("/usr/share/doc/libhwy-dev/copyright").read_bytes(), 0o644


def spdx(name, files, created, version_of_highway):
    lines = [
        "SPDXVersion: SPDX-2.3",
        "DataLicense: CC0-1.0",
        "SPDXID: SPDXRef-DOCUMENT",
        f"DocumentName: {name}",
        f"DocumentNamespace: urn:halfspace:{name}:{git('rev-parse', 'HEAD').decode().strip()}",
        "Creator: Tool: source_archive.py",
        f"Created: {created}",
    ]
    packages = [
        ("halfspace", name.rpartition("-")[2], "MIT", "Copyright (c) 2026 The halfspace authors"),
        ("highway", version_of_highway, "Apache-2.0", "2019 Google LLC and others"),
    ]
    for package, version, licence, copyright_text in packages:
        inside = [f for f in files if f[0].startswith("third_party/") == (package == "highway")]
        sums = sorted(hashlib.sha1(data).hexdigest() for _, data, _ in inside)
        lines += [
            "",
            f"PackageName: {package}",
            f"SPDXID: SPDXRef-{package}",
            f"PackageVersion: {version}",
            "PackageDownloadLocation: NOASSERTION",
            f"PackageVerificationCode: {hashlib.sha1(''.join(sums).encode()).hexdigest()}",
            f"PackageLicenseConcluded: {licence}",
            f"PackageLicenseDeclared: {licence}",
            f"PackageCopyrightText: {copyright_text}",
            f"Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-{package}",
        ]
        for path, data, _ in inside:
            lines += [
                "",
                f"FileName: ./{path}",
                f"SPDXID: SPDXRef-file-{hashlib.sha1(path.encode()).hexdigest()}",
                f"FileChecksum: SHA1: {hashlib.sha1(data).hexdigest()}",
                f"LicenseConcluded: {licence}",
            ]
    return "\n".join(lines) + "\n"


def main():
    base = (INCLUDE / "hwy/base.h").read_text() + (INCLUDE / "hwy/highway.h").read_text()
    parts = [re.search(rf"define HWY_{p} (\d+)", base)[1] for p in ("MAJOR", "MINOR", "PATCH")]
    version = re.search(r'VERSION_STRING "(.*)"', git("show", "HEAD:include/halfspace/version.h").decode())[1]
    seconds = int(git("log", "-1", "--format=%ct"))
    created = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))
    name = f"halfspace-{version}"
    files = [*sources(), *headers()]
    files.append(("sbom.spdx", spdx(name, files, created, ".".join(parts)).encode(), 0o644))
    with open(sys.argv[1], "wb") as raw, gzip.GzipFile("", "wb", mtime=seconds, fileobj=raw) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
            for path, data, mode in sorted(files):
                member = tarfile.TarInfo(f"{name}/{path}")
                member.size, member.mode, member.mtime = len(data), mode, seconds
                archive.addfile(member, io.BytesIO(data))


if __name__ == "__main__":
    main()
