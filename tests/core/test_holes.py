"""addon/fill/holes.py: which holes a selection means."""

import itertools

import numpy as np
import pytest

from addon.fill.holes import OpenEdge, all_of, of_selection


def grid(columns, rows, without=()):
    """Squares (i, j) of a grid as lists of vertex numbers, but for some."""
    number = lambda i, j: j * (columns + 1) + i  # noqa: E731
    return [
        [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
        for j in range(rows)
        for i in range(columns)
        if (i, j) not in set(without)
    ]


def edges_of(faces, wires=(), selected=(), hidden=()):
    """Open edges of faces and wires, and the edges with two faces or more."""
    runs = {}
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            runs.setdefault(frozenset((a, b)), []).append((a, b))
    chosen, shut = ({frozenset(edge) for edge in group} for group in (selected, hidden))
    edges = [
        OpenEdge(directed[0][::-1], False, key in chosen, key in shut)
        for key, directed in runs.items()
        if len(directed) == 1
    ]
    edges += [OpenEdge(edge, True, frozenset(edge) in chosen, frozenset(edge) in shut) for edge in wires]
    closed = [directed[0] for key, directed in runs.items() if len(directed) > 1 and key in chosen]
    return edges, closed


def cycle(*vertices):
    return list(itertools.pairwise([*vertices, vertices[0]]))


def select(faces=(), *, wires=(), selected=(), hidden=(), vertices=(), close_chains=False, strict=True):
    edges, closed = edges_of(faces, wires, selected, hidden)
    ends = {vertex for edge in selected for vertex in edge}
    return of_selection(edges, closed, ends | set(vertices), close_chains=close_chains, strict=strict)


def loops(found):
    assert not found.problems
    return sorted(sorted(hole.vertices) for hole in found.holes)


HOLE = [6, 7, 12, 11]  # around square (1, 1) of a grid of 4 by 4
RING = grid(4, 4, [(1, 1)])


def test_selected_loop_runs_against_its_faces():
    (hole,) = select(RING, selected=cycle(*HOLE)).holes
    runs = set(cycle(*hole.vertices))
    assert set(hole.vertices) == set(HOLE)
    for face in RING:
        assert not runs & set(cycle(*face))
    assert not hole.closing


@pytest.mark.parametrize("start", range(4))
@pytest.mark.parametrize("backward", [False, True])
def test_order_of_selection_does_not_matter(start, backward):
    order = (HOLE * 2)[start : start + 4]
    (hole,) = select(RING, selected=cycle(*(order[::-1] if backward else order))).holes
    assert hole == select(RING, selected=cycle(*HOLE)).holes[0]


def test_part_of_a_rim_means_the_hole():
    for selected in ([(6, 7)], [(6, 7), (7, 12)], [(11, 6), (12, 7)]):
        assert loops(select(RING, selected=selected)) == [sorted(HOLE)]


def test_a_vertex_means_the_hole():
    assert loops(select(RING, vertices=[12])) == [sorted(HOLE)]


def test_vertices_of_one_hole_mean_it_once():
    assert loops(select(RING, vertices=HOLE)) == [sorted(HOLE)]


def test_edge_of_the_outer_border_means_the_border():
    ((hole,), problems) = (select(RING, selected=[(0, 1)]).holes, select(RING, selected=[(0, 1)]).problems)
    assert len(hole.vertices) == 16
    assert not problems


def test_several_holes_at_once():
    faces = grid(7, 4, [(1, 1), (3, 1), (5, 2)])
    assert loops(select(faces, selected=[(9, 10), (19, 20)], vertices=[21])) == [
        [9, 10, 17, 18],
        [11, 12, 19, 20],
        [21, 22, 29, 30],
    ]


def test_all_holes_and_their_size():
    faces = grid(8, 8, [(1, 1), (3, 1), (4, 1), (1, 4), (2, 4), (1, 5), (2, 5)])
    edges, _ = edges_of(faces)
    sizes = sorted(len(hole.vertices) for hole in all_of(edges, 0).holes)
    assert sizes == [4, 6, 8, 32]
    found = all_of(edges, 6)
    assert sorted(len(hole.vertices) for hole in found.holes) == [4, 6]
    assert found.larger == 2


def test_hidden_holes_are_left_alone():
    edges, _ = edges_of(RING, hidden=[(6, 7)])
    found = all_of(edges, 8)
    assert (found.holes, found.hidden) == ([], 1)
    found = select(RING, selected=[(7, 12)], hidden=[(6, 7)])
    assert not found.holes
    assert "the hole of 4 edges is hidden in part; reveal it first" in found.problems[0].reason
    assert "on no hole" in select(RING, hidden=cycle(*HOLE), vertices=[6]).problems[0].reason


def test_holes_that_touch_at_a_vertex_are_two():
    faces = grid(4, 4, [(1, 1), (2, 2)])
    rims = [*cycle(*HOLE), *cycle(12, 13, 18, 17)]
    expected = [[6, 7, 11, 12], [12, 13, 17, 18]]
    assert loops(select(faces, selected=rims)) == expected
    assert loops(select(faces, vertices=[12])) == expected
    assert loops(select(faces, selected=[(6, 7)])) == [[6, 7, 11, 12]]
    assert sorted(len(hole.vertices) for hole in all_of(edges_of(faces)[0], 10).holes) == [4, 4]


def test_hole_that_touches_the_border():
    faces = grid(4, 4, [(1, 0), (0, 1)])
    # The squares at (1, 0) and (0, 1) are notches of the border; they touch each other at vertex 6.
    found = all_of(edges_of(faces)[0], 0)
    assert not found.problems
    for hole in found.holes:
        assert len(set(hole.vertices)) == len(hole.vertices)
    assert sum(len(hole.vertices) for hole in found.holes) == len(edges_of(faces)[0])


def test_faces_of_the_other_winding_do_not_matter():
    faces = [face[::-1] if at % 2 else face for at, face in enumerate(RING)]
    assert loops(select(faces, vertices=[6])) == [sorted(HOLE)]
    assert sorted(len(hole.vertices) for hole in all_of(edges_of(faces)[0], 0).holes) == [4, 16]


def test_wire_loop():
    wires = cycle(0, 1, 2, 3, 4)
    for selected in (wires, wires[:1], wires[1:4]):
        assert loops(select(wires=wires, selected=selected)) == [[0, 1, 2, 3, 4]]
    assert loops(select(wires=wires, vertices=[3])) == [[0, 1, 2, 3, 4]]
    assert not all_of(edges_of([], wires)[0], 0).holes


def test_loop_of_rim_and_wire_edges():
    """A wire across the opening of a U closes a loop with a part of its rim."""
    faces = grid(3, 2, [(1, 0)])
    found = select(faces, wires=[(1, 2)], selected=cycle(1, 2, 6, 5))
    assert loops(found) == [[1, 2, 5, 6]]


def test_selected_faces_around_a_hole():
    """Edges and vertices of the selected faces are not given at all; the rest lie on the hole."""
    edges, _ = edges_of(RING, selected=[(6, 7), (7, 12)])
    assert loops(of_selection(edges, [], [], close_chains=False, strict=True)) == [sorted(HOLE)]


def test_vertex_mode_ignores_edges_that_come_along():
    faces = [*grid(4, 4, [(1, 1), (2, 1)])]
    rim = cycle(6, 7, 8, 13, 12, 11)
    along = [*rim, (12, 17)]
    assert loops(select(faces, selected=along, strict=False)) == [[6, 7, 8, 11, 12, 13]]
    assert loops(select(faces, selected=along[1:], strict=False)) == [[6, 7, 8, 11, 12, 13]]
    assert loops(select(faces, selected=[(12, 17)], strict=False)) == [[6, 7, 8, 11, 12, 13]]


@pytest.mark.parametrize("strict", [True, False])
def test_loops_with_a_selected_edge_between_them_are_all_found(strict):
    """Only the first of them was."""
    faces = grid(5, 4, [(1, 1), (3, 2)])
    holes = [cycle(7, 8, 14, 13), cycle(15, 16, 22, 21)]
    found = select(faces, selected=[*holes[0], (14, 15), *holes[1]], strict=strict)
    assert loops(found) == [[7, 8, 13, 14], [15, 16, 21, 22]]


class TestProblems:
    def only(self, found):
        assert not found.holes
        (problem,) = found.problems
        return problem

    def test_nothing(self):
        assert "nothing is selected" in self.only(select(RING)).reason

    def test_only_closed_faces(self):
        """Edges and vertices of selected faces are not given; that something is selected is."""
        edges, _ = edges_of(RING)
        found = of_selection(edges, [], [], close_chains=False, strict=True, anything=True)
        assert self.only(found).reason.startswith("what is selected has no open edges;")

    def test_vertex_on_no_hole(self):
        faces = grid(4, 4)
        assert self.only(select(faces, vertices=[12])).reason.startswith("vertex 12 lies on no hole")
        problem = self.only(select(faces, vertices=[11, 12]))
        assert problem.reason.startswith("none of the selected vertices lies on a hole")
        assert problem.vertices == (11, 12)

    def test_open_chain(self):
        wires = [(0, 1), (1, 2), (2, 3)]
        problem = self.only(select(wires=wires, selected=wires))
        assert (
            "they end at vertices 0 and 3; select the missing edges or turn on Close Chains" in problem.reason
        )
        assert problem.vertices == (0, 3)
        assert problem.edges == tuple(wires)

    def test_open_chain_closed(self):
        wires = [(0, 1), (2, 1), (2, 3)]
        (hole,) = select(wires=wires, selected=wires, close_chains=True).holes
        assert hole.closing
        assert hole.vertices in {(0, 1, 2, 3), (3, 2, 1, 0)}

    def test_open_chain_beside_faces(self):
        chain = [(6, 7), (7, 12)]
        (hole,) = select(RING, selected=chain, close_chains=True).holes
        assert hole.closing
        assert set(hole.vertices) == {6, 7, 12}
        assert loops(select(RING, selected=chain)) == [sorted(HOLE)]
        # Vertices that are selected bring along edges across faces, here from the border to the hole.
        border = [(0, 1), (1, 2)]
        found = select(RING, selected=[*border, (1, 6), *chain], close_chains=True, strict=False)
        assert not found.problems
        assert all(not hole.closing for hole in found.holes)
        assert loops(select(RING, selected=chain[:1], close_chains=True)) == [sorted(HOLE)]
        assert loops(select(RING, selected=cycle(*HOLE), close_chains=True)) == [sorted(HOLE)]

    def test_single_wire(self):
        for close_chains in (False, True):
            found = select(wires=[(0, 1)], selected=[(0, 1)], close_chains=close_chains)
            assert "select at least three edges" in self.only(found).reason

    def test_branch(self):
        wires = [*cycle(0, 1, 2, 3), (2, 7)]
        problem = self.only(select(wires=wires, selected=wires))
        assert problem.reason.startswith("the selected edges branch at vertex 2;")
        assert problem.vertices == (2,)

    def test_figure_eight(self):
        wires = [*cycle(0, 1, 2), *cycle(2, 3, 4)]
        problem = self.only(select(wires=wires, selected=wires))
        assert "figure eight that meets itself at vertex 2" in problem.reason

    def test_loop_that_touches_itself(self):
        wires = [*cycle(0, 1, 2), *cycle(2, 3, 4), *cycle(4, 5, 6)]
        problem = self.only(select(wires=wires, selected=wires))
        assert "touches itself at vertices 2, 4" in problem.reason

    def test_loop_with_faces_on_both_sides(self):
        problem = self.only(select(grid(4, 4), selected=cycle(*HOLE)))
        assert "has faces on both sides" in problem.reason
        assert len(problem.edges) == 4

    def test_loop_with_one_edge_that_has_two_faces(self):
        faces = grid(4, 4, [(1, 1), (2, 1)])
        problem = self.only(
            select(faces, selected=[(6, 7), (7, 8), (8, 13), (13, 12), (12, 17), (17, 16), (16, 11), (11, 6)])
        )
        assert "the edge between vertices 11 and 16 (and 2 more) has faces on both sides" in problem.reason

    def test_rim_that_ends_at_a_fin(self):
        """Three faces at an edge leave borders of odd degree."""
        faces = [[0, 1, 2], [1, 0, 3], [0, 1, 4]]
        found = all_of(edges_of(faces)[0], 0)
        for hole in found.holes:
            assert len(set(hole.vertices)) == len(hole.vertices) >= 3

    def test_good_loops_are_used_beside_bad_ones(self):
        wires = [(40, 41), (41, 42)]
        found = select(RING, wires=wires, selected=[*cycle(*HOLE), *wires])
        assert [sorted(hole.vertices) for hole in found.holes] == [sorted(HOLE)]
        assert "end at vertices 40 and 42" in found.problems[0].reason


@pytest.mark.parametrize("seed", range(30))
def test_random_holes_cover_every_rim_once(seed):
    rng = np.random.default_rng(seed)
    gone = [tuple(square) for square in rng.integers(0, 9, (rng.integers(1, 30), 2))]
    faces = grid(9, 9, gone)
    edges, _ = edges_of(faces)
    found = all_of(edges, 0)
    assert not found.problems
    runs = [pair for hole in found.holes for pair in cycle(*hole.vertices)]
    assert sorted(map(sorted, runs)) == sorted(sorted(edge.ends) for edge in edges)
    for hole in found.holes:
        assert len(set(hole.vertices)) == len(hole.vertices) >= 3
    assert set(runs) == {edge.ends for edge in edges}, "each runs against its face"
