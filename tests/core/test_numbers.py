"""Meshes of pictures have about as many faces as were asked for, and fewer asked for never give more."""

from itertools import pairwise

import gridmesh
import numpy as np
import pytest
from rasters import coverage

from addon.pictures.cutouts import Options, cut_out

SIZE = 128
ASKED = (100, 200, 300, 500, 800)


def ring(radius, waves=0, height=0.0):
    turns = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    radii = radius * (1 + height * np.cos(waves * turns))
    return np.column_stack([np.cos(turns), np.sin(turns)]) * radii[:, None] + SIZE / 2


def star():
    turns = np.arange(10) * np.pi / 5 + 0.2
    return (
        np.column_stack([np.cos(turns), np.sin(turns)]) * np.where(np.arange(10) % 2, 56, 24)[:, None]
        + SIZE / 2
    )


def limbs(width):
    """A disk with five thin limbs."""
    alpha = coverage([ring(18)], SIZE, SIZE)
    for way in np.arange(5) * 2 * np.pi / 5 + 0.4:
        along = np.array([np.cos(way), np.sin(way)])
        across = width / 2 * np.array([-along[1], along[0]])
        bar = np.array([across, -across, 54 * along - across, 54 * along + across]) + SIZE / 2
        alpha = np.maximum(alpha, coverage([bar], SIZE, SIZE))
    return alpha


SIMPLE = {
    "disk": lambda: coverage([ring(50)], SIZE, SIZE),
    "flower": lambda: coverage([ring(45, 5, 0.15)], SIZE, SIZE),
    "block": lambda: coverage([np.array([[20, 24], [108, 30], [100, 96], [28, 104]], float)], SIZE, SIZE),
}
HARD = {
    "star": lambda: coverage([star()], SIZE, SIZE),
    "limbs": lambda: limbs(3.5),
    "thin": lambda: limbs(2.0),
}


def faces(alpha, cells, number, body):
    pixels = np.dstack([np.zeros((SIZE, SIZE, 3)), alpha])
    margin = 0.0 if body else 1.0
    cutout = cut_out(
        pixels,
        Options(threshold=0.5, margin=margin, cover=True, body={} if body else None, **{cells: number}),
    )
    assert not cutout.refused
    given = len(cutout.faces) / (2 if body else 1)
    assert cutout.asked == number
    # Whoever gets many more is told why.
    assert bool(cutout.finer) == (given > 1.2 * number)
    return given


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("name", SIMPLE)
def test_simple_shapes_get_the_number_asked_for(name, cells, body):
    alpha = SIMPLE[name]()
    for number in ASKED[1:]:
        assert faces(alpha, cells, number, body) == pytest.approx(number, rel=0.2)


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("name", HARD)
def test_fewer_asked_for_never_give_more(name, cells, body):
    alpha = HARD[name]()
    given = [faces(alpha, cells, number, body) for number in ASKED]
    for fewer, more in pairwise(given):
        # One size of a mesh varies by some faces with the place of the lattice.
        assert fewer <= 1.05 * more


@pytest.mark.parametrize("cells", ["triangles", "quads"])
@pytest.mark.parametrize("body", [None, {"depth": 0.5}])
def test_all_parts_of_a_picture_are_meshed_at_once(cells, body):
    parts = [(ring(50), []), (ring(8) + [70, 0], []), (ring(4) + [120, 0], [ring(2)[::-1] + [120, 0]])]
    told = []
    surfaces, finer = gridmesh.mesh_cutout(
        parts,
        margin=0.0 if body else 1.0,
        body=body,
        progress=lambda f: told.append(f) or True,
        **{cells: 700},
    )
    assert finer in {None, "thin", "cut_off", "area", "short", "beside"}
    assert told == sorted(told)
    for (outline, holes), surface in zip(parts, surfaces, strict=True):
        assert len(surface.silhouette) == 1 + len(holes)
        assert surface.report["watertight"] == bool(body)
        assert np.ptp(surface.vertices[:, 0]) == pytest.approx(np.ptp(outline[:, 0]), rel=0.1)
    again, _ = gridmesh.mesh_cutout(parts, margin=0.0 if body else 1.0, body=body, **{cells: 700})
    for one, other in zip(surfaces, again, strict=True):
        assert (one.vertices == other.vertices).all()


def test_a_part_that_cannot_be_meshed_is_an_error_of_its_own():
    eight = np.array([[0, 0], [40, 40], [40, 0], [0, 50]], float)
    surfaces, _ = gridmesh.mesh_cutout([(ring(50), []), (eight, [])], triangles=500)
    assert len(surfaces[0].triangles) > 400
    assert surfaces[1].kind == "self_intersecting"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"triangles": 100, "quads": 100}, "not both"),
        ({"triangles": 0}, "triangles is 0"),
        ({"margin": -1.0}, "margin is -1"),
        ({"margin": np.nan}, "margin is nan; allowed: a finite number of pixels, 0 or more"),
        ({"faint": 0.5}, "faint is 0.5"),
        ({"most": 0.0}, "most is 0"),
        ({"body": {"depth": 0.0}}, "depth is 0"),
        ({"progress": lambda _: False}, "cancelled"),
    ],
)
def test_options_that_are_not_allowed_are_refused(options, words):
    with pytest.raises(gridmesh.GridMeshError, match=words):
        gridmesh.mesh_cutout([(ring(50), [])], **options)


@pytest.mark.parametrize("name", ["margin", "cover", "faint", "most", "body"])
def test_arguments_of_a_wrong_type_are_named(name):
    with pytest.raises(TypeError, match=f"{name} is of type str; allowed: "):
        gridmesh.mesh_cutout([(ring(50), [])], **{name: "wide"})
    if name in {"margin", "faint", "most"}:
        with pytest.raises(TypeError, match=f"{name} is of type bool"):
            gridmesh.mesh_cutout([(ring(50), [])], **{name: True})


@pytest.mark.parametrize("name", ["slack", "across", "beyond"])
def test_arguments_of_a_wrong_type_are_named_by_covers_too(name):
    with pytest.raises(TypeError, match=f"{name} is of type str; allowed: "):
        gridmesh.cover_sketch(ring(50), **{name: "wide"})


def test_progress_rises_to_one():
    told = []
    gridmesh.mesh_cutout([(ring(50), []), (ring(20) + 100, [])], progress=told.append)
    assert told[0] == 0
    assert told[-1] == 1
    assert told == sorted(told)


def test_what_is_no_part_is_refused():
    whole = (ring(50), [])
    for parts, words in [
        (None, "parts is of type NoneType; allowed: a sequence of"),
        ([whole, None], "part 1 is of type NoneType; allowed: a pair"),
        ([ring(50)], "part 0 is of type ndarray; allowed: a pair"),
        ([whole, (ring(50),)], "part 1 is of type tuple; allowed: a pair"),
        ([whole, (ring(50), 3)], "holes of part 1 is of type int"),
        ([whole, (ring(50), ["x"])], "hole 0 of part 1 is of type str"),
        ([whole, ("x", [])], "outline of part 1 is of type str"),
    ]:
        with pytest.raises(TypeError, match=words):
            gridmesh.mesh_cutout(parts)
    with pytest.raises(TypeError, match="no option deep"):
        gridmesh.mesh_cutout([(ring(50), [])], body={"deep": 1.0})
    with pytest.raises(TypeError, match="3 is no name of an option of inflate"):
        gridmesh.mesh_cutout([whole], body={3: 1.0})
    [refused], _ = gridmesh.mesh_cutout([(np.zeros((5, 2)), [])])
    assert refused.kind == "too_few_points"
    assert gridmesh.mesh_cutout([]) == ([], None)
