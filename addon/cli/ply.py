# SPDX-License-Identifier: GPL-3.0-or-later
"""What the header of a PLY says of it. No bpy."""

from __future__ import annotations

import re
import struct

import numpy as np

_NUMPY = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_STRUCT = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
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


def fault(data) -> str | None:
    """What is wrong with places of vertices or indices of faces; None if nothing is, or what the file has is not understood.

    data : the whole file, as bytes or a memory map; not cut off.
    """
    end = _END.search(data)
    if end is None:
        return None
    elements: list[tuple[str, int, list[list[str]]]] = []
    for line in data[: end.start()].decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isascii() or not words[2].isdigit():
                return None
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"] and elements:
            elements[-1][2].append(words[1:])
    counts = [count for name, count, _ in elements if name == "vertex"]
    if len(counts) != 1:
        return None
    is_text = _ASCII.search(data[: end.start()]) is not None
    order = ">" if re.search(rb"^format binary_big", data[: end.start()], re.MULTILINE) else "<"
    try:
        rows = _words(data, end.end()) if is_text else None
        at = end.end()
        for name, count, properties in elements:
            first = 0
            if rows is None:
                first, at, bad = _checked(data, at, (name, count, properties), order, counts[0])
                if bad:
                    return bad
            for row in range(first, count):
                if rows is None:
                    values, at = _row(data, at, properties, order)
                else:
                    values = _text_row(next(rows), properties)
                if name == "vertex" and not np.isfinite([values.get(axis, 0.0) for axis in "xyz"]).all():
                    return f"vertex {row} is not at a finite place"
                if name == "face":
                    corners = values.get("vertex_indices", values.get("vertex_index", ()))
                    for corner in corners:
                        if not 0 <= corner < counts[0]:
                            return f"face {row} refers to vertex {int(corner)} of {counts[0]}"
    except (ValueError, IndexError, KeyError, StopIteration, struct.error):
        return None
    return None


def _checked(data, at: int, element, order: str, vertices: int) -> tuple[int, int, str | None]:
    """The first rows of a binary element in one step, if they are alike: how many, where they end, and what is wrong."""
    name, count, properties = element
    if all(kinds[0] != "list" for kinds in properties):
        row = np.dtype([(kinds[1], order + _NUMPY[kinds[0]]) for kinds in properties])
        if at + count * row.itemsize > len(data):
            return 0, at, None
        rows = np.frombuffer(data, row, count, at)
        axes = [rows[axis] for axis in "xyz" if axis in row.names] if name == "vertex" else []
        bad = [int(np.flatnonzero(~np.isfinite(axis))[0]) for axis in axes if not np.isfinite(axis).all()]
        return (
            count,
            at + count * row.itemsize,
            f"vertex {min(bad)} is not at a finite place" if bad else None,
        )
    if len(properties) != 1 or not count:
        return 0, at, None
    length, item = (np.dtype(order + _NUMPY[kind]) for kind in properties[0][1:3])
    end, left = _equal_lists(data, at, count, length, item)
    whole = count - left
    if name == "face" and whole and properties[0][3] in ("vertex_indices", "vertex_index"):
        size = int(np.frombuffer(data, length, 1, at)[0])
        rows = np.frombuffer(data, np.uint8, end - at, at).reshape(whole, -1)[:, length.itemsize :]
        corners = np.ascontiguousarray(rows).view(item).reshape(whole, max(size, 0))
        bad = np.argwhere((corners < 0) | (corners >= vertices))
        if len(bad):
            row, corner = bad[0]
            return whole, end, f"face {row} refers to vertex {int(corners[row, corner])} of {vertices}"
    return whole, end, None


def _words(data, at: int):
    """The words of each line that has some."""
    while at < len(data):
        end = data.find(b"\n", at)
        end = len(data) if end < 0 else end
        if words := data[at:end].split():
            yield words
        at = end + 1


def _text_row(words: list[bytes], properties: list[list[str]]) -> dict:
    values, k = {}, 0
    for kinds in properties:
        if kinds[0] == "list":
            length = int(words[k])
            values[kinds[3]] = [float(word) for word in words[k + 1 : k + 1 + length]]
            k += 1 + length
        else:
            values[kinds[1]] = float(words[k])
            k += 1
    return values


def _row(data, at: int, properties: list[list[str]], order: str) -> tuple[dict, int]:
    values = {}
    for kinds in properties:
        if kinds[0] == "list":
            (length,) = struct.unpack_from(order + _STRUCT[_NUMPY[kinds[1]]], data, at)
            at += np.dtype(_NUMPY[kinds[1]]).itemsize
            values[kinds[3]] = struct.unpack_from(f"{order}{length}{_STRUCT[_NUMPY[kinds[2]]]}", data, at)
            at += length * np.dtype(_NUMPY[kinds[2]]).itemsize
        else:
            (values[kinds[1]],) = struct.unpack_from(order + _STRUCT[_NUMPY[kinds[0]]], data, at)
            at += np.dtype(_NUMPY[kinds[0]]).itemsize
    return values, at
