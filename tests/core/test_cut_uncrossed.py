"""Parts that a stroke does not cross, caps that cannot bulge, and cuts that would be too large."""

from __future__ import annotations

import gridmesh
import numpy as np
import pytest
from test_cut import CUBE, DOWN, QUADS, circle, open_edges


def boxes(places: list[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    corners = [CUBE - 0.5 + [x, y, 0] for x, y in places]
    return np.vstack(corners), np.vstack([QUADS + 8 * k for k in range(len(places))])


@pytest.mark.parametrize("gap", [0.0, 0.05])
@pytest.mark.parametrize("keep", ["both", "left", "right"])
def test_parts_that_are_not_crossed_are_where_they_lie(keep, gap):
    """One is cut, one is above the line, one below, and one is where the line would go on."""
    vertices, faces = boxes([(0, 0), (4, 3), (4, -3), (8, 0)])
    stroke = np.array([[-0.3, 0.1, 0], [0.3, 0.11, 0]])
    done = gridmesh.cut(vertices, faces, stroke, direction=DOWN, keep=keep, gap=gap, extend_ends=False)
    beyond = 0
    for piece in done.pieces:
        parts, counts = np.unique(piece.source_face[piece.source_face >= 0] // 6, return_counts=True)
        found = dict(zip(parts.tolist(), counts.tolist(), strict=True))
        assert found.get(1, 0) == (6 if piece.side == "left" else 0)
        assert found.get(2, 0) == (6 if piece.side == "right" else 0)
        beyond += found.get(3, 0)
        assert len(open_edges(piece)) == 0
    assert beyond == 6


def test_caps_that_cannot_bulge_are_counted():
    options = {"direction": DOWN, "keep": "right", "edge_length": 0.1}
    hole = circle(0.5, 0.5, 0.3)
    done = gridmesh.cut(CUBE, QUADS, hole, smooth="tangent", **options)
    assert done.report["flat_caps"] == done.report["caps"] > 0
    assert gridmesh.cut(CUBE, QUADS, hole, **options).report["flat_caps"] == 0


@pytest.mark.parametrize(
    ("edge_length", "told"),
    [(1e-3, "triangles in its caps; at most 2000000"), (1e-4, "edges along its lines")],
)
def test_too_many_edges_or_triangles_are_told_as_such(edge_length, told):
    with pytest.raises(gridmesh.GridMeshError, match=told) as refused:
        gridmesh.cut(CUBE, QUADS, [[-1, 0.3, 0], [2, 0.6, 0]], direction=DOWN, edge_length=edge_length)
    assert refused.value.kind == "too_large"
