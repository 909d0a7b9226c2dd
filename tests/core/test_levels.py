"""Where the outline of a picture runs by itself: sheets hold glows and shadows, thin lines are widened, chalk is told from its board."""

from functools import partial

import gridmesh
import numpy as np
import pytest
from rasters import coverage, sampled

from addon.bodies.outlines import area
from addon.pictures.cutouts import Options, cut_out
from addon.pictures.level import LEVELS, level_of
from addon.pictures.tracing import traced

SIZE = 96


def away(x=48.0, y=48.0):
    """Distance of the middle of each pixel from a point."""
    rows, columns = np.mgrid[:SIZE, :SIZE] + 0.5
    return np.hypot(columns - x, SIZE - rows - y)


def disk(radius, x=48.0, y=48.0):
    return np.clip(radius + 0.5 - away(x, y), 0, 1)


def cut(alpha, **options):
    return cut_out(np.dstack([np.zeros((*alpha.shape, 3)), alpha]), Options(**{"triangles": 400, **options}))


def covered_by(cutout, size=SIZE):
    loops = [cutout.vertices[loop, :2] for loop in cutout.silhouette]
    return sampled(loops, size, size, 4)[::-1].reshape(size, 4, size, 4).mean(axis=(1, 3))


GLOW = np.exp(-(away() ** 2) / (2 * 15**2))
SHADOW = np.maximum(disk(20), 0.35 * np.clip((30 - away(56, 40)) / 8, 0, 1))


@pytest.mark.parametrize("alpha", [GLOW, SHADOW, 0.4 * disk(30)], ids=["glow", "shadow", "ghost"])
def test_a_sheet_holds_all_that_is_seen(alpha):
    """Outlines followed half cover, whatever was beyond: soft rims were cut off, and what was faint all over was refused."""
    left_out = alpha * (1 - covered_by(cut(alpha, margin=1.0)))
    assert left_out.sum() < 0.04 * alpha.sum()
    assert left_out.max() < 0.12


def test_edges_are_followed_where_they_were_drawn():
    """Neither anti-aliasing nor the noise of what is transparent is a glow."""
    drawn = coverage([np.array([[10.3, 12.1], [80.2, 20.7], [44.4, 85.9]])], SIZE, SIZE)
    noise = np.random.default_rng(0).integers(0, 8, (SIZE, SIZE)) / 255
    for alpha in (drawn, np.maximum(drawn, noise), disk(3), disk(40)):
        for is_body in (False, True):
            assert level_of(alpha, 1.0, is_body) == 0.5
    assert covered_by(cut(drawn, margin=0.0)) == pytest.approx(
        covered_by(cut(drawn, margin=0.0, threshold=0.5))
    )


def test_pores_of_a_glow_are_filled():
    """Small holes where a glow fades made the mesh thirty times as fine."""
    pores = [(20, 48), (76, 48), (48, 20)]
    alpha = GLOW * np.min([1 - disk(3, *pore) for pore in pores], axis=0)
    # A dot in the first, which the sheet covers as it is.
    alpha = np.maximum(alpha, disk(1, *pores[0]))
    cutout = cut(alpha, margin=0.0, min_area=1.0)
    assert (cutout.parts, len(cutout.silhouette)) == (1, 1)
    assert covered_by(cutout)[alpha > 0.1].min() > 0.9
    kept = cut(alpha, margin=0.0, min_area=0.0)
    assert len(kept.silhouette) > 3
    assert len(cutout.faces) < len(kept.faces)


def test_a_wide_margin_holds_a_glow_by_itself():
    assert level_of(GLOW, 1.0, False) == LEVELS[-1]
    assert level_of(np.maximum(disk(20), 0.3 * disk(26)), 1.0, False) < 0.5
    assert level_of(np.maximum(disk(20), 0.3 * disk(26)), 7.0, False) == 0.5


def test_a_body_is_what_is_opaque_or_else_what_there_is():
    assert level_of(SHADOW, 0.0, True) == 0.5
    cutout = cut(0.4 * disk(30), body={}, cover=True)
    assert np.ptp(cutout.vertices[:, :2], axis=0) == pytest.approx(60, abs=1)


def test_nothing_is_seen_of_an_empty_picture():
    assert level_of(np.zeros((4, 5)), 1.0, False) == 0.5
    assert level_of(np.zeros((1, 1)), 1000.0, True) == 0.5


def test_lines_too_thin_for_a_body_are_widened(monkeypatch):
    """A tree whose twigs got thinner and thinner lost its trunk, which is one part with them."""
    monkeypatch.setattr(gridmesh, "mesh_cutout", partial(gridmesh.mesh_cutout, most=1.0))
    trunk = np.array([[44, 8], [52, 8], [52, 88], [44, 88]], float)
    twigs = [
        np.array([[48, y], [8, y + 7], [8, y + 8.2], [48, y + 1.4]], float) for y in (20.0, 40.0, 60.0, 80.0)
    ]
    alpha = np.max([coverage([part], SIZE, SIZE) for part in [trunk, *twigs]], axis=0)
    cutout = cut(alpha, body={}, cover=True, triangles=200)
    assert cutout.widened == 0.5
    assert not cutout.refused
    assert (covered_by(cutout)[10:86, 45:51] > 0.9).all()
    assert cut(disk(30), body={}, cover=True).widened == 0.0


def test_what_is_wider_is_at_the_same_level():
    """Half cover would do for a margin of 2, so outlines made wider became narrower."""
    alpha = np.maximum(disk(20), 0.3 * disk(22))
    assert level_of(alpha, 1.0, False) < level_of(alpha, 2.0, False) == 0.5
    pixels = np.dstack([np.zeros((SIZE, SIZE, 3)), alpha])
    radii = []
    for wider in (0.0, 1.0):
        outlines = traced(gridmesh, pixels, Options(margin=1.0), None, wider)
        [(outline, _)] = outlines.parts
        radii.append(np.sqrt(area(outline) / np.pi))
        assert outlines.faint == 2
    assert radii[1] > radii[0] + 0.7


@pytest.mark.parametrize("board", [(0.1, 0.1, 0.12), (0.1, 0.35, 0.2)])
def test_chalk_on_a_board_is_what_is_drawn(board):
    """The board was taken for a drawing on bright paper, with the lines as holes."""
    rows, columns = np.mgrid[:SIZE, :SIZE] / SIZE
    light = (1.0 - 0.3 * rows * columns)[..., None]
    line = (np.abs(away() - 30) < 4)[..., None]
    picture = np.where(line, 0.85, board * light)
    [(outline, holes)] = gridmesh.trace_image(picture, background="paper", min_area=20)
    assert np.hypot(*(outline - 48).T) == pytest.approx(34, abs=0.7)
    assert np.hypot(*(holes[0] - 48).T) == pytest.approx(26, abs=0.7)
