"""Random items of a batch, good and hostile, with their files. What they make is the same for the same seed."""

from __future__ import annotations

import base64
import contextlib
import json
import math
import os
import random
import socket
import struct
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1] / "core"))

from picture_files import hostile as hostile_pictures
from picture_files import png

SUFFIXES = {
    "strokes": (".json", ".csv", ".svg"),
    "fill": (".obj", ".ply", ".stl", ".glb", ".gltf"),
    "cut": (".obj", ".ply"),
    "sprites": (".png",),
}
NAMES = (
    "plain", "mit Leerzeichen", "größe", "日本語", "‮rtl", "a'; rm -rf x", "new\nline", "tab\t", "%20", "-o", "{name}", "dot.dot",
    os.fsdecode(b"caf\xe9"), os.fsdecode(b"\xff\xfe"), "n" * 180, "\u2028", "\x85", "*?[a]", "a\\b",
)  # fmt: skip


@dataclass
class Item:
    """A job, and what must come of it."""

    job: dict
    statuses: tuple[str, ...]
    """Those that are right."""
    what: str
    """Its kind, for the counts."""


class Maker:
    """Makes items and their files in a folder."""

    def __init__(self, folder: Path, seed: int, only: str | None = None) -> None:
        """Only: the operation of all good items."""
        self.folder, self.random, self.count, self.only = folder, random.Random(seed), 0, only
        (folder / "in").mkdir(parents=True)
        (folder / "out.ply").mkdir()
        (folder / "file").write_text("no folder")

    def name(self, suffix: str) -> str:
        """Relative path of a new input."""
        self.count += 1
        return f"in/{self.random.choice(NAMES)} {self.count}{suffix}"

    def write(self, suffix: str, data: bytes) -> str:
        """Relative path of a new input with these contents."""
        name = self.name(suffix)
        (self.folder / name).write_bytes(data)
        return name

    def good(self) -> Item:
        """An item that must be ok."""
        op = self.only or self.random.choice(["strokes", "strokes", "fill", "cut", "sprites"])
        suffix = self.random.choice(SUFFIXES[op])
        return Item(self.job(op, self.write(suffix, self.data(op, suffix))), ("ok",), f"good {op} {suffix}")

    def job(self, op: str, source: str, **changed: object) -> dict:
        """A job with random parameters."""
        self.count += 1
        name = f"{self.random.choice(NAMES)} {self.count}"
        params: dict = {}
        if op == "strokes":
            params = {"triangles": self.random.randint(150, 500), "depth": self.random.choice([0.5, 1, 1.5])}
        elif op == "cut":
            params = {"stroke": [[-9, self.random.uniform(-0.2, 0.2)], [9, self.random.uniform(-0.2, 0.2)]]}
        elif op == "sprites":
            params = {
                "triangles": self.random.randint(100, 400),
                "shape": self.random.choice(["flat", "body"]),
            }
        out = f"out/{name}.{'glb' if op == 'sprites' else 'ply'}"
        return {"id": name, "op": op, "in": source, "params": params, "out": out} | changed

    def data(self, op: str, suffix: str) -> bytes:
        """Contents of a good input."""
        if op == "strokes":
            return drawing(suffix, self.random)
        if op == "sprites":
            return picture(self.random)
        return model(suffix, self.random, opened=op == "fill")

    def hostile(self) -> Item:
        """An item that means harm."""
        kinds = [name for name in dir(self) if name.startswith("bad_")]
        kind = self.random.choice(kinds)
        job, statuses = getattr(self, kind)()
        return Item(job, statuses, f"hostile {kind.removeprefix('bad_')}")

    def any(self) -> tuple[str, str]:
        """An operation and an ending that it reads."""
        op = self.random.choice(list(SUFFIXES))
        return op, self.random.choice(SUFFIXES[op])

    ERROR = ("error",)
    NOT_OK = ("error", "warning")
    SOME = ("error", "warning", "ok")

    def bad_noise(self):
        op, suffix = self.any()
        return self.job(
            op, self.write(suffix, self.random.randbytes(self.random.randint(1, 5000)))
        ), self.NOT_OK

    def bad_empty(self):
        op, suffix = self.any()
        return self.job(op, self.write(suffix, b"")), self.ERROR

    def bad_picture(self):
        _, (data, _) = self.random.choice(sorted(hostile_pictures().items()))
        return self.job("sprites", self.write(".png", data)), self.ERROR

    def bad_cut_off(self):
        op, suffix = self.any()
        data = self.data(op, suffix)
        half = data[: self.random.randint(1, len(data) - 2)]
        return self.job(op, self.write(suffix, half)), self.SOME if suffix == ".csv" else self.NOT_OK

    def bad_flipped(self):
        op, suffix = self.any()
        data = bytearray(self.data(op, suffix))
        for _ in range(self.random.choice([1, 10, 100])):
            data[self.random.randrange(len(data))] = self.random.randrange(256)
        return self.job(op, self.write(suffix, bytes(data))), self.SOME

    def bad_kind(self):
        op, suffix = self.any()
        other, its = self.any()
        return self.job(op, self.write(suffix, self.data(other, its))), self.SOME

    def bad_odd_file(self):
        op, suffix = self.any()
        name = self.odd(suffix)
        return self.job(op, name), self.ERROR

    def odd(self, suffix: str) -> str:
        """Something that is no file."""
        name = self.name(suffix)
        path = self.folder / name
        kind = self.random.randrange(8)
        if kind == 0:
            os.mkfifo(path)
        elif kind == 1:
            path.mkdir()
        elif kind == 2:
            path.symlink_to(self.random.choice(["/dev/zero", "/dev/random", "/dev/tty", "/dev/full"]))
        elif kind == 3:
            path.symlink_to(path.name)
        elif kind == 4:
            pipe = self.name(".pipe")
            os.mkfifo(self.folder / pipe)
            path.symlink_to(self.folder / pipe)
        elif kind == 5:
            with path.open("wb") as file:
                file.truncate(self.random.choice([10**8, 10**11]))
        elif kind == 6:
            with (
                socket.socket(socket.AF_UNIX) as server,
                contextlib.suppress(OSError),
            ):  # long names cannot be
                server.bind(str(path))
        return name

    def bad_stroke(self):
        source = self.write(".obj", model(".obj", self.random, opened=False))
        job = self.job("cut", source)
        job["params"] = {"stroke": self.odd(".csv")}
        return job, self.ERROR

    def bad_uri(self):
        uri = self.random.choice(
            ["/dev/zero", "../../../../../../../../etc/passwd", "a%00.bin", "\ud800.bin", "\udcff.bin", "http://127.0.0.1:9/a", ".", "",
             "data:/../../file", "%2e%2e/file", "file:///dev/zero", "//dev/zero", "x" * 5000, Path(self.odd(".bin")).name]
        )  # fmt: skip
        text = json.dumps(gltf(model_of(self.random, opened=True), uri)).encode()
        suffix = self.random.choice([".gltf", ".glb"])
        return self.job("fill", self.write(suffix, text if suffix == ".gltf" else glb(text))), self.ERROR

    def bad_materials(self):
        name = self.write(".obj", model(".obj", self.random, opened=True))
        os.mkfifo((self.folder / name).with_suffix(".mtl"))
        return self.job("fill", name), self.ERROR

    def bad_header(self):
        suffix, data = self.random.choice(
            [
                (".ply", b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\nend_header\n" % self.random.choice([2**31, 10**9, 10**12, 10**30])),
                (".ply", b"ply\nformat ascii 1.0\nelement face 1000000000\nproperty list uchar int vertex_indices\nend_header\n"),
                (".stl", bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(500)),
                (".glb", b"glTF" + struct.pack("<III", 2, 2**32 - 1, 2**32 - 1) + b"JSON{}"),
                (".obj", b"v 0 0 0\n" * 3 + b"f 1 2 99999999999999999999\n"),
                (".obj", b"f 1 2 3\n"),
                (".obj", b"v 1e400 nan inf\nv 0 0 0\nv 1 0 0\nf 1 2 3\n"),
            ]
        )  # fmt: skip
        return self.job("fill", self.write(suffix, data)), self.NOT_OK

    def bad_without_faces(self):
        suffix = self.random.choice([".obj", ".ply", ".stl"])
        points, _ = model_of(self.random, opened=False)
        return self.job("fill", self.write(suffix, encoded(suffix, points, []))), self.NOT_OK

    def bad_text(self):
        text = self.random.choice(
            ["[" * 100_000, '{"points": ' * 50_000, "[[[1e400, 0], [1, 0], [1, 1]]]", "[[[true, 0], [1, 0], [1, 1]]]", '[[["1", 0], [1, 0], [1, 1]]]',
             "[[[0, 0], [1, 0], [1, NaN]]]", "null", "[]", "{}", "7", '"x"', "[[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]", f"[[[{'9' * 400}, 0], [1, 0], [1, 1]]]",
             '{"points": [[0, 0], [1, 0], [1, 1]], "holes": 3}', "[[[0, 0], [0, 0], [0, 0]]]", "[[[0, 0], [1, 0]]]"]
        )  # fmt: skip
        return self.job("strokes", self.write(".json", text.encode())), self.ERROR

    def bad_svg(self):
        body = self.random.choice(
            ["<g>" * 20_000, '<path d="M 0 0 L nan 1 L 1 1 z"/>', '<!DOCTYPE a [<!ENTITY b "bbbb">]><a>&b;</a>', "<use href='#a' id='a'/>", "\0", "<path d='", "<circle r='-1'/>"]
        )  # fmt: skip
        return self.job(
            "strokes", self.write(".svg", f"<svg xmlns='http://www.w3.org/2000/svg'>{body}".encode())
        ), self.ERROR

    def bad_path(self):
        source = self.write(".json", drawing(".json", self.random))
        return self.random.choice(
            [
                (self.job("strokes", source, out="out/\ud800.ply"), self.ERROR),
                (self.job("strokes", "in/\udfff.json"), self.ERROR),
                (self.job("strokes", source, out="out.ply"), self.ERROR),
                (self.job("strokes", source, out="file/a.ply"), self.ERROR),
                (self.job("strokes", source, out=f"out/{'x' * 300}.ply"), self.ERROR),
                (self.job("strokes", "in/" + "y/" * 3000 + "a.json"), self.ERROR),
                (self.job("strokes", "in/nothing.json"), self.ERROR),
                (self.job("strokes", source, out="/proc/a.ply"), self.ERROR),
                (self.job("strokes", source, id="\ud800" + str(self.count)), ("ok",)),
            ]
        )

    def bad_overwriting(self):
        source = self.write(".ply", model(".ply", self.random, opened=True))
        way = self.random.choice(["", "in/../", "in/nowhere/../../"])
        return self.job("fill", source, out=way + source), self.ERROR

    def bad_parameters(self):
        source = self.write(".json", drawing(".json", self.random))
        job = self.job("strokes", source)
        job["params"] = self.random.choice(
            [{"depth": 1e308}, {"depth": -1}, {"triangles": 0}, {"edge_length": 1e-300}, {"curve": [5, 5]}, {"close_gaps": 1, "triangles": 5}]
        )  # fmt: skip
        return job, self.SOME

    def bad_appetite(self):
        source = self.write(".json", drawing(".json", self.random))
        job = self.job("strokes", source)
        job["params"] = {"triangles": self.random.choice([10**8, 2**31 - 1])}
        return job, self.ERROR


def drawing(suffix: str, rng: random.Random) -> bytes:
    """A smooth closed curve."""
    waves, height, n = rng.randint(2, 5), rng.uniform(0, 0.25), rng.randint(60, 200)
    phase, size = rng.uniform(0, 6), rng.choice([1, 10, 100])
    turns = [2 * math.pi * at / n for at in range(n)]
    points = [
        [size * (1 + height * math.sin(waves * t + phase)) * f(t) for f in (math.cos, math.sin)]
        for t in turns
    ]
    if suffix == ".json":
        return json.dumps({"points": points}).encode()
    if suffix == ".csv":
        return "".join(f"{x},{y}\n" for x, y in points).encode()
    path = " L ".join(f"{x:.6f} {y:.6f}" for x, y in points)
    return f'<svg xmlns="http://www.w3.org/2000/svg"><path d="M {path} z"/></svg>\n'.encode()


def picture(rng: random.Random) -> bytes:
    """A PNG of a lobed shape on nothing, with soft edges."""
    width, height = rng.randint(24, 96), rng.randint(24, 96)
    y, x = np.mgrid[:height, :width] + 0.5
    x, y = (x - width / 2), (y - height / 2)
    radius = min(width, height) * (
        0.36 + 0.08 * np.sin(rng.randint(2, 5) * np.arctan2(y, x) + rng.uniform(0, 6))
    )
    alpha = np.clip(radius - np.hypot(x, y) + 0.5, 0, 1)
    return png(np.rint(255 * np.dstack([0 * x + rng.random(), 0 * x + rng.random(), 0.5 + y / 200, alpha])))


def model_of(rng: random.Random, *, opened: bool) -> tuple[list, list]:
    """Points and triangles of a ball, with some left out if it is to be open."""
    n, rings = rng.randint(10, 24), rng.randint(6, 14)
    points = [[0.0, 0.0, 1.0]]
    for ring in range(1, rings):
        up = math.pi * ring / rings
        points += [
            [
                math.sin(up) * math.cos(2 * math.pi * at / n),
                math.sin(up) * math.sin(2 * math.pi * at / n),
                math.cos(up),
            ]
            for at in range(n)
        ]
    points.append([0.0, 0.0, -1.0])
    faces = []
    for at in range(n):
        to = (at + 1) % n
        faces.append([0, 1 + at, 1 + to])
        last = 1 + (rings - 2) * n
        faces.append([last + to, last + at, len(points) - 1])
        for ring in range(rings - 2):
            a, b = 1 + ring * n, 1 + (ring + 1) * n
            faces += [[a + at, b + at, b + to], [a + at, b + to, a + to]]
    if opened:
        faces = [face for face in faces if 0 not in face]
        used = sorted({one for face in faces for one in face})
        number = {one: at for at, one in enumerate(used)}
        points = [points[one] for one in used]
        faces = [[number[one] for one in face] for face in faces]
    return points, faces


def model(suffix: str, rng: random.Random, *, opened: bool) -> bytes:
    """A file of a ball."""
    points, faces = model_of(rng, opened=opened)
    if suffix in (".gltf", ".glb"):
        data = b"".join(struct.pack("<3f", *point) for point in points) + b"".join(
            struct.pack("<3I", *face) for face in faces
        )
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        text = json.dumps(gltf((points, faces), uri)).encode()
        return text if suffix == ".gltf" else glb(text)
    return encoded(suffix, points, faces)


def encoded(suffix: str, points: list, faces: list) -> bytes:
    """A file of these triangles."""
    if suffix == ".obj":
        lines = [f"v {x:.7f} {y:.7f} {z:.7f}\n" for x, y, z in points] + [
            f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces
        ]
        return "".join(lines).encode()
    if suffix == ".stl":
        corners = [[number for at in face for number in points[at]] for face in faces]
        return (
            bytes(80)
            + struct.pack("<I", len(faces))
            + b"".join(struct.pack("<12fH", 0, 0, 0, *face, 0) for face in corners)
        )
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    return (
        head.encode()
        + b"".join(struct.pack("<3f", *point) for point in points)
        + b"".join(struct.pack("<B3i", 3, *face) for face in faces)
    )


def gltf(shape: tuple[list, list], uri: str) -> dict:
    """glTF of these triangles, whose bytes are at the URI."""
    points, faces = shape
    first, second = 12 * len(points), 12 * len(faces)
    low, high = ([pick(point[at] for point in points) for at in range(3)] for pick in (min, max))
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": first + second, "uri": uri}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": first},
            {"buffer": 0, "byteOffset": first, "byteLength": second},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(points),
                "type": "VEC3",
                "min": low,
                "max": high,
            },
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
    }


def glb(text: bytes) -> bytes:
    """Binary glTF with no bytes of its own."""
    text += b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<II", 2, 20 + len(text)) + struct.pack("<I", len(text)) + b"JSON" + text
