"""Files of pictures: what they hold comes back, and what cannot be read is refused by name."""

import gridmesh
import numpy as np
import pytest
from picture_files import WEBP, disk, hostile, jpeg, png


def test_colours_come_back():
    values = np.random.default_rng(1).integers(0, 256, (7, 5, 4), np.uint8)
    assert (gridmesh.decode_image(png(values)) == values).all()
    assert (gridmesh.decode_image(bytearray(png(values))) == values).all()


@pytest.mark.parametrize("channels", [1, 2, 3])
def test_grey_and_opaque_pictures_become_colours_with_alpha(channels):
    values = np.random.default_rng(2).integers(0, 256, (6, 9, channels), np.uint8)
    found = gridmesh.decode_image(png(values))
    colours = values[..., :1] if channels < 3 else values
    assert (found[..., :3] == colours).all()
    assert (found[..., 3] == (values[..., 1] if channels == 2 else 255)).all()


def test_sixteen_bits_are_rounded():
    found = gridmesh.decode_image(png(disk(deep=True)))
    assert np.abs(found.astype(int) - disk()).max() <= 1


def test_a_palette_with_alpha():
    numbers = np.array([[[0], [1]], [[2], [0]]], np.uint8)
    colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]]
    found = gridmesh.decode_image(png(numbers, palette=(colours, [255, 128, 0])))
    assert found[0].tolist() == [[255, 0, 0, 255], [0, 255, 0, 128]]
    assert found[1].tolist() == [[0, 0, 255, 0], [255, 0, 0, 255]]


def test_cmyk_becomes_colours():
    # Inverted: much cyan and no other ink is what lacks red.
    found = gridmesh.decode_image(jpeg([55, 255, 255, 255]))
    assert found.shape == (8, 8, 4)
    assert np.abs(found[0, 0].astype(int) - [55, 255, 255, 255]).max() <= 3


def test_photographs_and_webp():
    grey = gridmesh.decode_image(jpeg([90], 20))
    assert grey.shape == (20, 20, 4)
    assert np.abs(grey[..., :3].astype(int) - 90).max() <= 2
    assert gridmesh.decode_image(jpeg([180, 128, 128]))[3, 3].tolist() == [180, 180, 180, 255]
    assert gridmesh.decode_image(WEBP).shape == (1, 1, 4)


@pytest.mark.parametrize("name", hostile())
def test_what_is_no_picture_is_refused(name):
    data, kind = hostile()[name]
    with pytest.raises(gridmesh.GridMeshError) as caught:
        gridmesh.decode_image(data)
    assert caught.value.kind == kind
    assert "allowed" in str(caught.value)


def test_no_prefix_and_no_flipped_byte_breaks_it():
    rng = np.random.default_rng(3)
    for good in (png(disk(24, 9)), jpeg([200, 100, 150], 24), WEBP):
        for end in range(0, len(good), max(1, len(good) // 60)):
            try:
                found = gridmesh.decode_image(good[:end])
            except gridmesh.GridMeshError as error:
                assert error.kind == "picture_format"
            else:  # all of its pixels were there
                assert end > 0.9 * len(good)
                assert (found == gridmesh.decode_image(good)).all()
        for _ in range(150):
            wrong = bytearray(good)
            wrong[rng.integers(len(wrong))] = rng.integers(256)
            try:
                found = gridmesh.decode_image(bytes(wrong))
            except gridmesh.GridMeshError as error:
                assert error.kind in {"picture_format", "picture_size"}
            else:
                assert found.dtype == np.uint8


@pytest.mark.parametrize("wrong", [None, "a.png", 3, [1, 2], np.zeros(3)])
def test_only_bytes_are_read(wrong):
    with pytest.raises(TypeError, match="bytes"):
        gridmesh.decode_image(wrong)


def test_what_is_decoded_can_be_traced():
    [(outline, holes)] = gridmesh.trace_image(gridmesh.decode_image(png(disk(64, 20))))
    assert holes == []
    assert np.hypot(*(outline - 32).T) == pytest.approx(20, abs=0.2)
