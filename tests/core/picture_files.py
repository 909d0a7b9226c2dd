"""Files of pictures, good and hostile, written byte by byte."""

import base64
import struct
import zlib

import numpy as np

WEBP = base64.b64decode("UklGRhoAAABXRUJQVlA4TA0AAAAvAAAAEAcQERGIiP4HAA==")
"""One pixel without a colour, transparent."""

_LAYOUTS = {(1, False): 0, (3, False): 2, (2, False): 4, (4, False): 6}


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def png(values, before=b"", palette=None, layout=None):
    """(h, w, c) of uint8 or uint16; `palette`: (colours, alphas) of an (h, w, 1) array of their numbers."""
    values = np.asarray(values)
    height, width, channels = values.shape
    kind = 3 if palette else {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    wide = values.astype(">u2") if values.dtype == np.uint16 else values.astype(np.uint8)
    rows = b"".join(b"\0" + row.tobytes() for row in wide)
    head = struct.pack(">IIBBBBB", width, height, 8 * wide.itemsize, kind, 0, 0, 0)
    if palette:
        colours, alphas = palette
        before += chunk(b"PLTE", bytes(np.ravel(colours).tolist())) + chunk(b"tRNS", bytes(alphas))
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + before
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def png_that_claims(width, height):
    """A PNG whose head says this size."""
    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    rows = zlib.compress(bytes(1000))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def moving_png():
    """Two frames, of which the first is the picture itself."""
    rows = zlib.compress((b"\0" + b"\xff" * 16) * 4)
    control = struct.pack(">IIIIIHHBB", 0, 4, 4, 0, 0, 1, 10, 0, 0)
    other = struct.pack(">IIIIIHHBB", 1, 4, 4, 0, 0, 1, 10, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        [
            chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 6, 0, 0, 0)),
            chunk(b"acTL", struct.pack(">II", 2, 0)),
            chunk(b"fcTL", control),
            chunk(b"IDAT", rows),
            chunk(b"fcTL", other),
            chunk(b"fdAT", struct.pack(">I", 2) + rows),
            chunk(b"IEND", b""),
        ]
    )


def moving_webp():
    """One frame of an animation: that of `WEBP`."""
    picture = WEBP[12:]
    size = bytes(3)
    frame = bytes(3) + bytes(3) + size + size + struct.pack("<I", 100)[:3] + b"\0" + picture
    chunks = [(b"VP8X", b"\x12\0\0\0" + size + size), (b"ANIM", bytes(6)), (b"ANMF", frame)]
    body = b"".join(
        name + struct.pack("<I", len(data)) + data + bytes(len(data) % 2) for name, data in chunks
    )
    return b"RIFF" + struct.pack("<I", len(body) + 4) + b"WEBP" + body


def jpeg(channels, size=8):
    """A baseline JPEG of one colour in each channel (1: grey, 3: YCbCr, 4: CMYK, as Adobe writes it, inverted)."""

    def segment(marker, data):
        return bytes([0xFF, marker]) + struct.pack(">H", len(data) + 2) + data

    n = len(channels)
    blocks = (-(-size // 8)) ** 2
    bits = ""
    for at in range(blocks):
        for value in channels:
            level = value - 128 if at == 0 else 0  # later blocks: no difference
            length = abs(level).bit_length()
            coded = level if level > 0 else level + (1 << length) - 1
            bits += f"{length:04b}" + (f"{coded:0{length}b}" if length else "") + "0"
    bits += "1" * (-len(bits) % 8)
    data = bytes(int(bits[at : at + 8], 2) for at in range(0, len(bits), 8)).replace(b"\xff", b"\xff\0")
    parts = bytes(range(1, n + 1))
    frame = struct.pack(">BHHB", 8, size, size, n) + b"".join(bytes([part, 0x11, 0]) for part in parts)
    scan = bytes([n]) + b"".join(bytes([part, 0]) for part in parts) + b"\0\x3f\0"
    return b"".join(
        [
            b"\xff\xd8",
            segment(0xEE, b"Adobe\0\x64\0\0\0\0" + bytes([1 if n == 3 else 0])),
            segment(0xDB, b"\0" + bytes([8] * 64)),
            segment(0xC0, frame),
            segment(0xC4, b"\0" + bytes([0, 0, 0, 12] + [0] * 12) + bytes(range(12))),
            segment(0xC4, b"\x10" + bytes([1] + [0] * 15) + b"\0"),
            segment(0xDA, scan),
            data,
            b"\xff\xd9",
        ]
    )


def disk(size=64, radius=20, *, deep=False):
    """(h, w, 4): an orange disk on nothing."""
    y, x = np.mgrid[:size, :size] + 0.5 - size / 2
    alpha = np.clip(radius + 0.5 - np.hypot(x, y), 0, 1)
    most = 65535 if deep else 255
    colour = np.broadcast_to(np.array([0.9, 0.4, 0.1]), (size, size, 3))
    values = np.rint(most * np.dstack([colour, alpha]))
    return values.astype(np.uint16 if deep else np.uint8)


def hostile():
    """Files from which no picture can be made, and the word for each."""
    good = png(disk())
    photo = jpeg([200, 100, 150], 64)
    wrong = bytearray(good)
    wrong[len(good) // 2] ^= 0x40
    return {
        "empty": (b"", "picture_format"),
        "text": (b"no picture at all", "picture_format"),
        "gif": (b"GIF89a\x01\0\x01\0\0\0\0;", "picture_format"),
        "only its head": (good[:8], "picture_format"),
        "cut off in its head": (good[:20], "picture_format"),
        "cut off": (good[: len(good) // 2], "picture_format"),
        "without its last rows": (good[:-40], "picture_format"),
        "a wrong bit": (bytes(wrong), "picture_format"),
        "too large": (png_that_claims(40_000, 40_000), "picture_size"),
        "no pixels": (png_that_claims(0, 7), "picture_format"),
        "far too large": (png_that_claims(2**31 - 1, 2**31 - 1), "picture_format"),
        "less than it says": (png_that_claims(2000, 2000), "picture_format"),
        "moving png": (moving_png(), "picture_format"),
        "moving webp": (moving_webp(), "picture_format"),
        "webp cut off": (WEBP[:-9], "picture_format"),
        "jpeg cut off": (photo[:-6], "picture_format"),
        "jpeg without a scan": (photo[:100], "picture_format"),
    }
