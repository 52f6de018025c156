#!/usr/bin/env python3
"""Writes a furnished house of about 150,000 triangles in a few surfaces: boards, boxes, chairs of bent tubes, stairs
and mouldings, joined by material as modelling programs export them. It measures how an atlas copes with many small
pieces; the same file every time.

    tools/make_house.py house.glb [--scale 1]      --scale .1 makes a tenth of the furniture
"""

import argparse
import json
import math
import random
import struct

HALF_X, HALF_Z, HEIGHT = 7.0, 6.0, 2.7


class Mesh:
    """Triangles of one material, flat shaded but for tubes."""

    def __init__(self):
        self.positions, self.normals, self.indices = [], [], []

    def quad(self, a, b, c, d, normals=None):
        """Counter-clockwise from the front."""
        first = len(self.positions)
        flat = normalized(cross(minus(b, a), minus(d, a)))
        self.positions += [a, b, c, d]
        self.normals += normals or [flat] * 4
        self.indices += [first, first + 1, first + 2, first, first + 2, first + 3]

    def box(self, low, high):
        x0, y0, z0 = low
        x1, y1, z1 = high
        self.quad((x0, y1, z0), (x0, y1, z1), (x1, y1, z1), (x1, y1, z0))
        self.quad((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))
        self.quad((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
        self.quad((x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0))
        self.quad((x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1))
        self.quad((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0))

    def sweep(self, frames, profile, closed):
        """`frames`: (origin, x axis, y axis) along a path; `profile`: points in x and y, and their normals or None."""
        rings = [[add(o, add(scaled(x, p[0]), scaled(y, p[1]))) for p, _ in profile] for o, x, y in frames]
        turned = [[n and add(scaled(x, n[0]), scaled(y, n[1])) for _, n in profile] for _, x, y in frames]
        count = len(profile)
        for i in range(len(frames) - 1):
            for j in range(count if closed else count - 1):
                k = (j + 1) % count
                normals = [turned[i][j], turned[i][k], turned[i + 1][k], turned[i + 1][j]]
                self.quad(rings[i][j], rings[i][k], rings[i + 1][k], rings[i + 1][j],
                          normals if normals[0] else None)


def add(a, b):
    return tuple(p + q for p, q in zip(a, b))


def minus(a, b):
    return tuple(p - q for p, q in zip(a, b))


def scaled(a, s):
    return tuple(p * s for p in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalized(a):
    length = math.sqrt(sum(p * p for p in a)) or 1
    return scaled(a, 1 / length)


def tube(mesh, path, radius, sides):
    profile = [((radius * math.cos(t), radius * math.sin(t)), (math.cos(t), math.sin(t)))
               for t in (2 * math.pi * i / sides for i in range(sides))]
    frames = []
    x = normalized(cross(minus(path[1], path[0]), (0.31, 0.17, 0.93)))
    for i, p in enumerate(path):
        along = normalized(minus(path[min(i + 1, len(path) - 1)], path[max(i - 1, 0)]))
        x = normalized(minus(x, scaled(along, sum(a * b for a, b in zip(x, along)))))
        frames.append((p, x, cross(along, x)))
    mesh.sweep(frames, profile, True)


def bent(points, radius, steps):
    """The points' polyline with its corners rounded."""
    path = [points[0]]
    for before, corner, after in zip(points, points[1:], points[2:]):
        a = add(corner, scaled(normalized(minus(before, corner)), radius))
        b = add(corner, scaled(normalized(minus(after, corner)), radius))
        for i in range(steps + 1):
            t = i / steps
            path.append(add(scaled(a, (1 - t) ** 2), add(scaled(corner, 2 * t * (1 - t)), scaled(b, t * t))))
    return path + [points[-1]]


def chair(metal, seat, at, turn):
    c, s = math.cos(turn), math.sin(turn)

    def place(p):
        return (at[0] + c * p[0] + s * p[2], at[1] + p[1], at[2] - s * p[0] + c * p[2])

    for side in (-0.2, 0.2):
        frame = bent([(side, 0.01, -0.2), (side, 0.01, 0.22), (side, 0.44, 0.2), (side, 0.44, -0.2),
                      (side, 0.85, -0.24)], 0.06, 8)
        tube(metal, [place(p) for p in frame], 0.0125, 14)
    for y, z in ((0.44, 0.2), (0.01, -0.2), (0.85, -0.24)):
        tube(metal, [place((-0.2, y, z)), place((0.2, y, z))], 0.0125, 14)
    for i in range(4):
        z = -0.18 + 0.09 * i
        slat = [place(p) for p in ((-0.21, 0.455, z), (-0.21, 0.455, z + 0.08), (0.21, 0.455, z + 0.08),
                                   (0.21, 0.455, z))]
        under = [add(p, (0, -0.012, 0)) for p in slat]
        seat.quad(*slat)
        seat.quad(*under[::-1])
        for j in range(4):
            k = (j + 1) % 4
            seat.quad(under[j], under[k], slat[k], slat[j])


def shell(meshes):
    """Outer walls with windows, inner walls, ceiling and ground floor."""
    wall = meshes["wall"]
    t = 0.2
    for sign in (-1, 1):
        z = sign * HALF_Z
        low, high = min(z, z + sign * t), max(z, z + sign * t)
        for i in range(7):
            x = -HALF_X + 2 * i
            if i % 2:
                wall.box((x, 0, low), (x + 2, 0.9, high))
                wall.box((x, 2.2, low), (x + 2, HEIGHT, high))
            else:
                wall.box((x, 0, low), (x + 2, HEIGHT, high))
        x = sign * HALF_X
        wall.box((min(x, x + sign * t), 0, -HALF_Z), (max(x, x + sign * t), HEIGHT, HALF_Z))
    for x in (-2.4, 2.2):
        for z0, z1 in ((-HALF_Z, -3.2), (-2.2, 2.0), (3.0, HALF_Z)):
            wall.box((x, 0, z0), (x + 0.12, HEIGHT, z1))
        wall.box((x, 2.1, -3.2), (x + 0.12, HEIGHT, -2.2))
        wall.box((x, 2.1, 2.0), (x + 0.12, HEIGHT, 3.0))
    for x0, x1 in ((-HALF_X, -5.2), (-4.2, -2.4), (2.32, 4.0), (5.0, HALF_X)):
        wall.box((x0, 0, -0.06), (x1, HEIGHT, 0.06))
    meshes["ceiling"].box((-HALF_X, HEIGHT, -HALF_Z), (HALF_X, HEIGHT + 0.2, HALF_Z))
    meshes["screed"].box((-HALF_X, -0.2, -HALF_Z), (HALF_X, -0.02, HALF_Z))


def boards(meshes, count):
    """A floor of boards with joints of two millimetres, in two kinds of wood."""
    rows = max(1, round(math.sqrt(count * 2 * HALF_Z / (2 * HALF_X) * 8)))
    per_row = max(1, round(count / rows))
    width, length = 2 * HALF_Z / rows, 2 * HALF_X / per_row
    for r in range(rows):
        for i in range(per_row):
            x0 = -HALF_X + (i - 0.5 * (r % 2)) * length
            x1, x0 = min(x0 + length, HALF_X) - 0.001, max(x0, -HALF_X) + 0.001
            z0 = -HALF_Z + r * width
            meshes["oak" if (r + i) % 3 else "ash"].box((x0, -0.02, z0 + 0.001), (x1, 0, z0 + width - 0.001))


def furniture(meshes, rng, scale):
    kinds = [f"box {i}" for i in range(20)]
    for i in range(round(500 * scale)):
        size = (rng.uniform(0.05, 0.5), rng.uniform(0.03, 0.5), rng.uniform(0.05, 0.4))
        x, z = rng.uniform(-6.5, 6), rng.uniform(-5.5, 5)
        y = rng.choice((0, 0, 0.4, 0.8, 1.2, 1.6))
        meshes[kinds[i % len(kinds)]].box((x, y, z), add((x, y, z), size))
    for i in range(round(60 * scale)):
        at = (-6 + 12 * (i % 10) / 9.0, 0, -5 + 10 * (i // 10) / 5.0)
        chair(meshes[f"metal {i % 3}"], meshes["seat"], at, rng.uniform(0, 2 * math.pi))
    for i in range(max(2, round(16 * scale))):  # stairs with risers and a rail of balusters
        z, y = 0.8 + 0.27 * i, 0.17 * (i + 1)
        if y > HEIGHT - 0.3:
            break
        meshes["stairs"].box((-1.0, y - 0.04, z), (0.0, y, z + 0.3))
        meshes["stairs"].box((-1.0, y - 0.17, z + 0.02), (0.0, y - 0.04, z + 0.04))
        for x in (-0.97, -0.03):
            tube(meshes["rail"], [(x, y, z + 0.13), (x, y + 0.9, z + 0.13)], 0.012, 14)
    for w in range(6):  # blinds before the windows
        x0, side = -HALF_X + 2 + 4 * (w % 3), -1 if w < 3 else 1
        for i in range(max(3, round(40 * scale))):
            y, z = 0.95 + 1.2 * i / max(3, round(40 * scale)), side * (HALF_Z - 0.05)
            meshes["blind"].box((x0 + 0.05, y, z - 0.02), (x0 + 1.95, y + 0.003, z + 0.02))


def mouldings(meshes, scale):
    """Skirting and cornices with a rounded profile along all outer walls, in pieces of a third of a metre."""
    step = 0.33 / max(scale, 0.1)
    arc = [(0.03 * math.cos(t), 0.03 * math.sin(t)) for t in (math.pi / 2 * i / 6 for i in range(7))]
    profile = [((0.0, 0.09), None)] + [((0.004 + p[0] * 0.5, 0.05 + p[1]), None) for p in arc[::-1]] + \
              [((0.019, 0.0), None)]
    profile = profile[::-1]
    for name, y, up in (("skirting", 0.0, 1), ("cornice", HEIGHT, -1)):
        for inward, along, origin, length in (
                ((1, 0, 0), (0, 0, -1), (-HALF_X, y, HALF_Z), 2 * HALF_Z),
                ((-1, 0, 0), (0, 0, 1), (HALF_X, y, -HALF_Z), 2 * HALF_Z),
                ((0, 0, 1), (1, 0, 0), (-HALF_X, y, -HALF_Z), 2 * HALF_X),
                ((0, 0, -1), (-1, 0, 0), (HALF_X, y, HALF_Z), 2 * HALF_X)):
            count = max(1, round(length / step))
            for i in range(count):
                ends = [(add(origin, scaled(along, length * (i + k) / count)), inward, (0, up, 0))
                        for k in (0.002, 0.998)]
                meshes[name].sweep(ends if up > 0 else ends[::-1], profile, False)


def lamps(meshes):
    for x in (-4.7, 0.0, 4.6):
        for z in (-3.0, 3.0):
            y = HEIGHT - 0.02
            meshes["lamp"].quad((x - 0.4, y, z - 0.4), (x + 0.4, y, z - 0.4), (x + 0.4, y, z + 0.4),
                                (x - 0.4, y, z + 0.4))


def material_of(name, rng):
    if name == "lamp":
        return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
                "emissiveFactor": [1, 1, 1],
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 12.0}}}
    metal = name.startswith(("metal", "rail"))
    bright = {"wall": 0.8, "ceiling": 0.85}.get(name)
    color = [bright] * 3 if bright else [round(rng.uniform(0.25, 0.8), 3) for _ in range(3)]
    return {"name": name, "pbrMetallicRoughness": {"baseColorFactor": color + [1], "metallicFactor": float(metal),
                                                   "roughnessFactor": 0.35 if metal else 0.7}}


def write(path, meshes, rng):
    blob, views, accessors, primitives, materials = bytearray(), [], [], [], []

    def accessor(data, kind, component, count, **bounds):
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob.extend(data)
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind,
                          **bounds})
        return len(accessors) - 1

    for name, mesh in meshes.items():
        if not mesh.indices:
            continue
        flat = [[v for p in values for v in p] for values in (mesh.positions, mesh.normals)]
        low, high = ([f(p[i] for p in mesh.positions) for i in range(3)] for f in (min, max))
        count = len(mesh.positions)
        primitives.append({"attributes": {
            "POSITION": accessor(struct.pack(f"<{3 * count}f", *flat[0]), "VEC3", 5126, count, min=low, max=high),
            "NORMAL": accessor(struct.pack(f"<{3 * count}f", *flat[1]), "VEC3", 5126, count)},
            "indices": accessor(struct.pack(f"<{len(mesh.indices)}I", *mesh.indices), "SCALAR", 5125,
                                len(mesh.indices)),
            "material": len(materials)})
        materials.append(material_of(name, rng))
    turn = [0, math.sin(0.45), 0, math.cos(0.45)]
    document = {
        "asset": {"version": "2.0", "generator": "make_house.py"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [1.6, 1.6, 5.2], "rotation": turn}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.05}}],
        "meshes": [{"primitives": primitives}], "materials": materials, "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}], "extensionsUsed": ["KHR_materials_emissive_strength"]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    blob.extend(b"\0" * (-len(blob) % 4))
    with open(path, "wb") as file:
        file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A) + text +
                   struct.pack("<II", len(blob), 0x004E4942) + blob)
    return sum(len(mesh.indices) // 3 for mesh in meshes.values()), len(primitives)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output")
    parser.add_argument("--scale", type=float, default=1)
    arguments = parser.parse_args()
    names = ["wall", "ceiling", "screed", "oak", "ash", "seat", "stairs", "rail", "blind", "skirting", "cornice", "lamp"]
    names += [f"metal {i}" for i in range(3)] + [f"box {i}" for i in range(20)]
    meshes = {name: Mesh() for name in names}
    rng = random.Random(7)
    shell(meshes)
    boards(meshes, round(2000 * arguments.scale))
    furniture(meshes, rng, arguments.scale)
    mouldings(meshes, arguments.scale)
    lamps(meshes)
    triangles, surfaces = write(arguments.output, meshes, rng)
    print(f"{triangles} triangles in {surfaces} surfaces")


if __name__ == "__main__":
    main()
