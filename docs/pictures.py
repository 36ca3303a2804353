#!/usr/bin/env python3
"""Takes pictures and curves out of a page of `sph report`, for documents.

Usage: python3 docs/pictures.py REPORT.html FILE=CAPTION[+CAPTION...] ...

FILE.png gets the flow of the first figure with this caption; several captions are put side by side.
FILE.svg gets the curves. Without FILE=CAPTION, the captions of the page are listed. Needs nothing but Python.
"""

import base64
import html
import re
import struct
import sys
import zlib

STYLE = (
    "<style>text{font:12px sans-serif;fill:#333}.axis{fill:none;stroke:#333}"
    ".grid{fill:none;stroke:#e2e2e2}.zero{fill:none;stroke:#999}"
    ".line{fill:none;stroke-width:1.6;stroke-linejoin:round}</style>"
    '<rect width="100%" height="100%" fill="#fff"/>'
)
GAP = 8  # white pixels between pictures


def figures(page):
    """Captions and bodies of the figures, in order."""
    for figure in re.findall(r"<figure.*?</figure>", page, re.S):
        caption = re.search(r"<figcaption>(.*?)</figcaption>", figure, re.S)
        if caption:
            yield html.unescape(caption.group(1)), figure


def decoded(data):
    """Palette and rows of a PNG as `sph report` writes it: one byte per pixel, unfiltered."""
    at, palette, packed, width = 8, b"", b"", 0
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at:at + 4]), data[at + 4:at + 8]
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, _, depth, colours = struct.unpack(">IIBB", body[:10])
            assert (depth, colours) == (8, 3), "not a picture of sph report"
        elif kind == b"PLTE":
            palette = body
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw = zlib.decompress(packed)
    step = width + 1
    assert not any(raw[::step]), "the rows are filtered"
    return palette, [raw[k + 1:k + step] for k in range(0, len(raw), step)]


def encoded(palette, rows):
    """The same as a PNG."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)
    packed = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"PLTE", palette)
            + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def picture(bodies):
    """The flow of some figures, side by side. Colour 0 is white."""
    joined, palette = None, None
    for body in bodies:
        data = re.search(r"data:image/png;base64,([A-Za-z0-9+/=]+)", body)
        if not data:
            sys.exit("this figure has no picture")
        palette, rows = decoded(base64.b64decode(data.group(1)))
        joined = rows if joined is None else [a + bytes(GAP) + b for a, b in zip(joined, rows)]
    return encoded(palette, joined)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        page = list(figures(file.read()))
    if len(sys.argv) == 2:
        print("\n".join(caption for caption, _ in page))
    for wish in sys.argv[2:]:
        name, _, captions = wish.partition("=")
        bodies = []
        for caption in captions.split("+"):
            body = next((body for have, body in page if have == caption), None)
            if body is None:
                sys.exit(f"there is no figure '{caption}' in {sys.argv[1]}")
            bodies.append(body)
        if name.endswith(".png"):
            data = picture(bodies)
        else:
            svg = re.search(r"<svg.*?</svg>", bodies[0], re.S).group(0)
            svg = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
            data = svg.replace(">", ">" + STYLE, 1).encode()
        with open(name, "wb") as file:
            file.write(data)
        print(f"{name}: {len(data)} bytes")


if __name__ == "__main__":
    main()
