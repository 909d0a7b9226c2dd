# SPDX-License-Identifier: GPL-3.0-or-later
"""Which holes of a mesh are meant: from its open edges and what is selected of it to loops of vertices.

No bpy. An edge is open if it has one face, or none (a wire). All else in the mesh is closed to a patch.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

Edge = tuple[int, int]


@dataclass(frozen=True)
class OpenEdge:
    """An edge that a patch could be attached to."""

    ends: Edge
    """Vertices, in the direction in which a patch runs: against the face, if there is one."""
    wire: bool = False
    selected: bool = False
    hidden: bool = False


@dataclass(frozen=True)
class Hole:
    """A closed loop of open edges without a repeated vertex, at least three."""

    vertices: tuple[int, ...]
    """In the direction of most of its edges."""
    closing: bool = False
    """Whether the edge from the last vertex to the first is still to be made."""


@dataclass(frozen=True)
class Problem:
    """Something selected that cannot be filled: why, what to do, and where."""

    reason: str
    vertices: tuple[int, ...] = ()
    edges: tuple[Edge, ...] = ()


@dataclass
class Found:
    """Holes to fill, what stands in the way of others, and holes left alone on purpose."""

    holes: list[Hole] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    larger: int = 0
    hidden: int = 0
    mirrored: int = 0
    """At the plane of a Mirror modifier, where the other half goes on."""
    across: int = 0
    """With edges at such a plane and others, whose mirror image is the other half of the hole."""
    outer: int = 0
    """Outer borders of flat sheets, on which a patch would lie."""
    _known: set[frozenset[int]] = field(default_factory=set)

    def add(self, hole: Hole) -> None:
        """Add a hole, unless it is there already."""
        key = frozenset(hole.vertices)
        if key not in self._known:
            self._known.add(key)
            self.holes.append(hole)


def of_selection(
    edges: list[OpenEdge],
    closed: Iterable[Edge],
    vertices: Iterable[int],
    *,
    close_chains: bool,
    strict: bool,
    anything: bool = False,
) -> Found:
    """Find the holes that a selection means.

    A selected loop of open edges is a hole; where only a part of one is selected, or a vertex, the whole hole is
    meant.

    edges : all open edges. closed : selected edges that are not open and belong to no selected face.
    vertices : selected vertices of no selected face. close_chains : whether chains of open edges are closed by a
    straight edge.
    strict : whether `closed` were selected one by one, and not because both their ends are. anything : whether
    anything at all is selected, such as faces.
    """
    found = Found()
    graph = _Graph(edges)
    visible = [edge for edge in edges if edge.selected and not edge.hidden]
    covered: set[int] = set()
    for part, barred in _components(visible, closed):
        barred = barred if strict else []
        covered.update(vertex for edge in (*part, *barred) for vertex in _ends(edge))
        if part or barred:
            _resolve(part, barred, graph, found, close_chains)
    alone = sorted(set(vertices) - covered)
    on_holes = [vertex for vertex in alone if graph.open_around(vertex)]
    for vertex in on_holes:
        _whole(graph.open_around(vertex), graph, found, [])
    if not on_holes and not found.holes and not found.problems:
        found.problems.append(_nothing(alone, anything=anything))
    return found


def all_of(edges: list[OpenEdge], max_edges: int) -> Found:
    """Find all holes that have faces around them and at most `max_edges` edges (0: any number)."""
    found = Found()
    graph = _Graph(edges)
    for hole in graph.rims([edge for edge in edges if not edge.wire], found.problems):
        if graph.is_hidden(hole):
            found.hidden += 1
        elif max_edges and len(hole.vertices) > max_edges:
            found.larger += 1
        else:
            found.add(hole)
    return found


def _nothing(alone: list[int], *, anything: bool) -> Problem:
    if len(alone) == 1:
        return Problem(f"vertex {alone[0]} lies on no hole; select a vertex or an edge of one", tuple(alone))
    if alone:
        reason = "none of the selected vertices lies on a hole; select a vertex or an edge of one"
        return Problem(reason, tuple(alone))
    if anything:
        return Problem("what is selected has no open edges; select an edge or a vertex of a hole")
    return Problem("nothing is selected; select the edges around a hole, or a vertex or an edge of it")


def _resolve(
    part: list[OpenEdge], barred: list[Edge], graph: _Graph, found: Found, close_chains: bool
) -> None:
    """Make holes of one connected piece of the selection, or say why not."""
    degrees = Counter(vertex for edge in part for vertex in edge.ends)
    if part and all(degree == 2 for degree in degrees.values()):
        # What is selected across loops, or from one to another, does not matter.
        pieces = [piece for piece, _ in _components(part, ())]
        if all(len(piece) >= 3 for piece in pieces):
            for piece in pieces:
                found.add(_loop(piece))
            return
    if barred:
        found.problems.append(_barred(barred))
        return
    branches = sorted(vertex for vertex, degree in degrees.items() if degree > 2)
    ends = sorted(vertex for vertex, degree in degrees.items() if degree == 1)
    if all(not edge.wire for edge in part):
        # Edges across faces, which do not matter, may hold several rows together.
        chain = _chain(part, ends[0]) if close_chains and len(ends) == 2 and not branches else []
        if len(chain) == len(part) + 1 >= 3:
            found.add(Hole(tuple(chain), closing=True))
        else:
            _whole(part, graph, found, [])
        return
    trouble: list[Problem] = []
    _whole(part, graph, found, trouble)
    if not trouble:
        return
    if branches:
        found.problems.append(_branching(branches, degrees, part))
        return
    if close_chains and len(part) >= 2:
        found.add(Hole(tuple(_chain(part, ends[0])), closing=True))
        return
    way_out = (
        "select the missing edges or turn on Close Chains"
        if len(part) >= 2
        else "select the missing edges or select at least three edges"
    )
    reason = f"the selected edges do not close: they end at vertices {ends[0]} and {ends[1]}; {way_out}"
    found.problems.append(Problem(reason, tuple(ends), tuple(edge.ends for edge in part)))


def _whole(part: list[OpenEdge], graph: _Graph, found: Found, trouble: list[Problem]) -> None:
    """Add the whole holes that some open edges lie on. Wires that close no loop go to `trouble`."""
    rims = [edge for edge in part if not edge.wire]
    holes = graph.rims(graph.reached(rims), found.problems) if rims else iter(())
    touched = {frozenset(edge.ends) for edge in rims}
    for hole in holes:
        if touched & {frozenset(pair) for pair in _pairs(hole.vertices)}:
            _add_visible(hole, graph, found)
    wires = [edge for edge in part if edge.wire]
    if not wires:
        return
    network = graph.connected(wires)
    degrees = Counter(vertex for edge in network for vertex in edge.ends)
    if len(network) >= 3 and all(degree == 2 for degree in degrees.values()):
        _add_visible(_loop(network), graph, found)
    else:
        open_ends = tuple(vertex for vertex, degree in degrees.items() if degree != 2)
        trouble.append(Problem("the wires close no loop", open_ends))


def _add_visible(hole: Hole, graph: _Graph, found: Found) -> None:
    if graph.is_hidden(hole):
        reason = f"the hole of {len(hole.vertices)} edges is hidden in part; reveal it first"
        found.problems.append(Problem(reason, hole.vertices))
    else:
        found.add(hole)


def _barred(edges: list[Edge]) -> Problem:
    a, b = edges[0]
    which = f"the edge between vertices {a} and {b}"
    if len(edges) > 1:
        which = f"{which} (and {len(edges) - 1} more)"
    return Problem(
        f"{which} has faces on both sides; select open edges only, or delete the faces that the patch shall replace",
        edges=tuple(edges),
    )


def _branching(branches: list[int], degrees: Counter[int], part: list[OpenEdge]) -> Problem:
    edges = tuple(edge.ends for edge in part)
    if len(branches) == 1 and degrees[branches[0]] == 4 and all(d % 2 == 0 for d in degrees.values()):
        return Problem(
            f"the selected edges form a figure eight that meets itself at vertex {branches[0]}; "
            "fill its two loops one after the other",
            (branches[0],),
            edges,
        )
    if all(degree % 2 == 0 for degree in degrees.values()):
        return Problem(
            f"the selected loop touches itself at vertices {_listed(branches)}; select one simple loop at a time",
            tuple(branches),
            edges,
        )
    return Problem(
        f"the selected edges branch at vertex {_listed(branches)}; deselect what does not belong to the loop",
        tuple(branches),
        edges,
    )


def _listed(vertices: list[int]) -> str:
    shown = ", ".join(map(str, vertices[:3]))
    return f"{shown} and {len(vertices) - 3} more" if len(vertices) > 3 else shown


class _Graph:
    """Open edges by vertex."""

    def __init__(self, edges: Iterable[OpenEdge]) -> None:
        self.around: dict[int, list[OpenEdge]] = {}
        self.hidden: set[frozenset[int]] = set()
        for edge in edges:
            for vertex in edge.ends:
                self.around.setdefault(vertex, []).append(edge)
            if edge.hidden:
                self.hidden.add(frozenset(edge.ends))

    def open_around(self, vertex: int) -> list[OpenEdge]:
        """Open edges at a vertex that are seen."""
        return [edge for edge in self.around.get(vertex, ()) if not edge.hidden]

    def is_hidden(self, hole: Hole) -> bool:
        """Whether an edge of the hole is hidden."""
        return any(frozenset(pair) in self.hidden for pair in _pairs(hole.vertices))

    def reached(self, edges: list[OpenEdge]) -> list[OpenEdge]:
        """Edges with one face that are connected with the given ones by such edges."""
        return self._spread(edges, wires=False)

    def connected(self, edges: list[OpenEdge]) -> list[OpenEdge]:
        """Open edges that are connected with the given ones."""
        return self._spread(edges, wires=True)

    def _spread(self, edges: list[OpenEdge], *, wires: bool) -> list[OpenEdge]:
        seen = dict.fromkeys(edges)
        waiting = list(edges)
        while waiting:
            for vertex in waiting.pop().ends:
                for other in self.around[vertex]:
                    if other not in seen and (wires or not other.wire):
                        seen[other] = None
                        waiting.append(other)
        return list(seen)

    def rims(self, edges: list[OpenEdge], problems: list[Problem]) -> Iterator[Hole]:
        """Walk along the rims of faces, and cut off a hole wherever the way meets itself.

        At a vertex where several holes touch the way goes on in the direction of the patch, if it can.
        """
        unused = dict.fromkeys(sorted(edges, key=lambda edge: edge.ends))
        while unused:
            start = next(iter(unused))
            path, taken = [start.ends[0]], []
            at = {start.ends[0]: 0}
            edge: OpenEdge | None = start
            while edge is not None:
                del unused[edge]
                taken.append(edge)
                vertex = edge.ends[1] if edge.ends[0] == path[-1] else edge.ends[0]
                if vertex in at:
                    begin = at[vertex]
                    loop = _oriented(path[begin:], taken[begin:])
                    for gone in path[begin + 1 :]:
                        del at[gone]
                    del path[begin + 1 :], taken[begin:]
                    if len(loop) >= 3:
                        yield Hole(loop)
                    else:
                        problems.append(_double(loop))
                else:
                    at[vertex] = len(path)
                    path.append(vertex)
                edge = _onward(path[-1], self.around[path[-1]], unused)
            if taken:
                ends = (path[0], path[-1])
                reason = (
                    f"the rim from vertex {ends[0]} to {ends[1]} does not close: more than two faces meet there; "
                    "delete the surplus face"
                )
                problems.append(Problem(reason, ends, tuple(edge.ends for edge in taken)))


def _onward(vertex: int, around: list[OpenEdge], unused: dict[OpenEdge, None]) -> OpenEdge | None:
    """Choose an unused edge at a vertex to go on with; None if there is none."""
    free = sorted((edge for edge in around if edge in unused), key=lambda edge: edge.ends)
    return next((edge for edge in free if edge.ends[0] == vertex), free[0] if free else None)


def _double(loop: tuple[int, ...]) -> Problem:
    return Problem(f"two edges join vertices {loop[0]} and {loop[1]}; merge them", loop)


def _oriented(loop: list[int], edges: list[OpenEdge]) -> tuple[int, ...]:
    """Loop of vertices, turned around if most of its edges run the other way."""
    forward = set(_pairs(loop))
    along = sum(edge.ends in forward for edge in edges if not edge.wire)
    against = sum(edge.ends[::-1] in forward for edge in edges if not edge.wire)
    return tuple(loop[:1] + loop[:0:-1]) if against > along else tuple(loop)


def _loop(edges: list[OpenEdge]) -> Hole:
    """Hole of edges that form one simple loop. Two vertices between two edges are no loop and not given."""
    start = min(vertex for edge in edges for vertex in edge.ends)
    return Hole(_oriented(_chain(edges, start), edges))


def _chain(edges: list[OpenEdge], start: int) -> list[int]:
    """Vertices of a chain or a simple loop in order."""
    around: dict[int, list[int]] = {}
    for edge in edges:
        a, b = edge.ends
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    path, before = [start], -1
    while True:
        onward = [vertex for vertex in around[path[-1]] if vertex != before]
        before = path[-1]
        if not onward or onward[0] == start:
            return path
        path.append(onward[0])


def _components(edges: list[OpenEdge], closed: Iterable[Edge]) -> Iterator[tuple[list[OpenEdge], list[Edge]]]:
    """Connected pieces of a selection: their open edges, and those that are not open."""
    everything: list[OpenEdge | Edge] = [*edges, *closed]
    around: dict[int, list[int]] = {}
    for index, edge in enumerate(everything):
        for vertex in _ends(edge):
            around.setdefault(vertex, []).append(index)
    seen = [False] * len(everything)
    for first in range(len(everything)):
        if seen[first]:
            continue
        seen[first] = True
        piece, at = [first], 0
        while at < len(piece):
            for vertex in _ends(everything[piece[at]]):
                for other in around[vertex]:
                    if not seen[other]:
                        seen[other] = True
                        piece.append(other)
            at += 1
        members = [everything[index] for index in sorted(piece)]
        yield (
            [edge for edge in members if isinstance(edge, OpenEdge)],
            [edge for edge in members if not isinstance(edge, OpenEdge)],
        )


def _ends(edge: OpenEdge | Edge) -> Edge:
    return edge.ends if isinstance(edge, OpenEdge) else edge


def _pairs(loop: Iterable[int]) -> list[Edge]:
    """Edges of a closed loop."""
    loop = list(loop)
    return list(zip(loop, loop[1:] + loop[:1], strict=True))
