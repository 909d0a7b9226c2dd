# SPDX-License-Identifier: GPL-3.0-or-later
"""What the header of a PLY says of it. No bpy."""

from __future__ import annotations

import re

import numpy as np

_NUMPY = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_ASCII = re.compile(rb"^format ascii\s", re.MULTILINE)
_END = re.compile(rb"^end_header\r?\n", re.MULTILINE)
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def is_ascii(data) -> bool:
    """Whether the header says that the file is text."""
    end = _END.search(data)
    return end is not None and _ASCII.search(data[: end.start()]) is not None


def binary_size(data) -> int | None:
    """Size that a binary PLY must have; more than it has if it is cut off; None if its header does not say.

    data : the whole file, as bytes or a memory map.
    """
    end = _END.search(data)
    if end is None:
        return None
    lines = [line.split() for line in data[: end.start()].decode("ascii", "replace").splitlines()]
    order = next((_ORDERS.get(words[1]) for words in lines if words[:1] == ["format"] and words[1:]), None)
    elements: list[tuple[int, list[list[np.dtype]]]] = []
    for words in lines:
        if words[:1] == ["property"] and elements:
            kinds = words[2:4] if words[1:2] == ["list"] else words[1:2]
            if any(kind not in _NUMPY for kind in kinds):
                return None
            elements[-1][1].append([np.dtype((order or "<") + _NUMPY[kind]) for kind in kinds])
        elif words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isascii() or not words[2].isdigit():
                return None
            elements.append((int(words[2]), []))
    if order is None:
        return None
    at = end.end()
    for count, properties in elements:
        at = _after(data, at, count, properties)
        if at > len(data):
            break
    return at


def _after(data, at: int, count: int, properties: list[list[np.dtype]]) -> int:
    """Where the rows of an element end that begin here: beyond the end of the data if they are cut off.

    properties : the type of each, of a list that of its length and that of its items.
    """
    if all(len(kinds) == 1 for kinds in properties):
        return at + count * sum(kinds[0].itemsize for kinds in properties)
    # A row has a byte at least: a count that no file could hold is not counted to.
    if at + count > len(data):
        return at + count
    if len(properties) == 1 and count:
        at, count = _equal_lists(data, at, count, *properties[0])
    for _ in range(count):
        for kinds in properties:
            if len(kinds) == 1:
                at += kinds[0].itemsize
                continue
            if at + kinds[0].itemsize > len(data):
                return len(data) + 1
            length = int(np.frombuffer(data, kinds[0], 1, at)[0])
            at += kinds[0].itemsize + max(length, 0) * kinds[1].itemsize
    return at


def _equal_lists(data, at: int, count: int, length: np.dtype, item: np.dtype) -> tuple[int, int]:
    """Where the first rows end that are lists as long as the first one, and how many rows are left: in one step."""
    if at + length.itemsize > len(data):
        return len(data) + 1, 0
    first = np.frombuffer(data, length, 1, at)[0]
    step = length.itemsize + max(int(first), 0) * item.itemsize
    whole = min(count, (len(data) - at) // step)
    rows = np.frombuffer(data, np.uint8, whole * step, at).reshape(whole, step)
    lengths = np.ascontiguousarray(rows[:, : length.itemsize]).view(length)[:, 0]
    others = np.flatnonzero(lengths != first)
    equal = int(others[0]) if len(others) else whole
    return at + equal * step, count - equal
