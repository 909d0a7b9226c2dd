# SPDX-License-Identifier: GPL-3.0-or-later
"""What a PLY has to hold by its header, and what of it is damaged. No bpy."""

from __future__ import annotations

import re
import struct
from typing import NamedTuple

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


class _Property(NamedTuple):
    name: str
    kinds: list[np.dtype]
    """The type of it, or of a list that of its length and that of its items."""


class _Element(NamedTuple):
    name: str
    count: int
    properties: list[_Property]


class _Header(NamedTuple):
    end: int
    order: str
    """Of the bytes of numbers; empty in a text."""
    elements: list[_Element]


def _header(data) -> _Header | None:
    """Read the header; None if there is none, or if it is not understood."""
    end = _END.search(data)
    if end is None:
        return None
    lines = [line.split() for line in data[: end.start()].decode("ascii", "replace").splitlines()]
    order = next((_ORDERS.get(words[1]) for words in lines if words[:1] == ["format"] and words[1:]), None)
    elements: list[_Element] = []
    for words in lines:
        if words[:1] == ["property"] and elements:
            kinds = words[2:4] if words[1:2] == ["list"] else words[1:2]
            if any(kind not in _NUMPY for kind in kinds):
                return None
            types = [np.dtype((order or "<") + _NUMPY[kind]) for kind in kinds]
            elements[-1].properties.append(_Property(words[-1], types))
        elif words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isascii() or not words[2].isdigit():
                return None
            elements.append(_Element(words[1], int(words[2]), []))
    if order is None and not is_ascii(data):
        return None
    return _Header(end.end(), order or "", elements)


def binary_size(data) -> int | None:
    """Size that a binary PLY must have; more than it has if it is cut off; None if its header does not say.

    data : the whole file, as bytes or a memory map.
    """
    header = _header(data)
    if header is None or not header.order:
        return None
    at = header.end
    for element in header.elements:
        at = _after(data, at, element.count, [own.kinds for own in element.properties])
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
    header = _header(data)
    counts = [element.count for element in header.elements if element.name == "vertex"] if header else []
    if len(counts) != 1:
        return None
    try:
        at, lines = header.end, _words(data, header.end)
        for element in header.elements:
            first = 0
            if header.order:
                first, at, bad = _checked(data, at, element, counts[0])
                if bad:
                    return bad
            for row in range(first, element.count):
                if header.order:
                    values, at = _row(data, at, element.properties)
                else:
                    values = _text_row(next(lines), element.properties)
                if (
                    element.name == "vertex"
                    and not np.isfinite([values.get(axis, 0.0) for axis in "xyz"]).all()
                ):
                    return f"vertex {row} is not at a finite place"
                if element.name == "face":
                    for corner in values.get("vertex_indices", values.get("vertex_index", ())):
                        if not 0 <= corner < counts[0]:
                            return f"face {row} refers to vertex {int(corner)} of {counts[0]}"
    except (ValueError, IndexError, StopIteration, struct.error):
        return None  # the importer says what it makes of that
    return None


def _checked(data, at: int, element: _Element, vertices: int) -> tuple[int, int, str | None]:
    """The first rows of a binary element in one step, if they are alike: how many, where they end, and what is wrong."""
    name, count, properties = element
    if all(len(own.kinds) == 1 for own in properties):
        row = np.dtype([(own.name, own.kinds[0]) for own in properties])
        if at + count * row.itemsize > len(data):
            return 0, at, None
        rows = np.frombuffer(data, row, count, at)
        axes = [rows[axis] for axis in "xyz" if axis in row.names] if name == "vertex" else []
        bad = [int(np.flatnonzero(~np.isfinite(axis))[0]) for axis in axes if not np.isfinite(axis).all()]
        said = f"vertex {min(bad)} is not at a finite place" if bad else None
        return count, at + count * row.itemsize, said
    if len(properties) != 1 or not count:
        return 0, at, None
    length, item = properties[0].kinds
    end, left = _equal_lists(data, at, count, length, item)
    whole = count - left
    if name == "face" and whole and properties[0].name in ("vertex_indices", "vertex_index"):
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


def _text_row(words: list[bytes], properties: list[_Property]) -> dict:
    values, k = {}, 0
    for name, kinds in properties:
        if len(kinds) == 2:
            length = int(words[k])
            values[name] = [float(word) for word in words[k + 1 : k + 1 + length]]
            k += 1 + length
        else:
            values[name] = float(words[k])
            k += 1
    return values


def _row(data, at: int, properties: list[_Property]) -> tuple[dict, int]:
    def read(kind: np.dtype, count: int) -> tuple:
        nonlocal at
        order = ">" if kind.str[0] == ">" else "<"
        found = struct.unpack_from(f"{order}{count}{kind.char}", data, at)
        at += count * kind.itemsize
        return found

    values = {}
    for name, kinds in properties:
        (value,) = read(kinds[0], 1)
        values[name] = read(kinds[1], value) if len(kinds) == 2 else value
    return values, at
