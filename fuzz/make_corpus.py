#!/usr/bin/env python3
"""Makes the corpus: small files of every kind that the fuzz targets read.

usage: fuzz/make_corpus.py PHAT     the program, e.g. build/release/phat
"""
import json
import pathlib
import struct
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORPUS = ROOT / "fuzz" / "corpus"
ENCODED = ROOT / "tests" / "data" / "encoded"
FINGERPRINT = 0x1122334455667788  # journal_layout.h


def glb(description, binary):
    text = json.dumps(description, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def room():
    """A floor, a wall, and a lamp that shines on them."""
    quads = [[(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)], [(-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1)],
             [(-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1)]]
    indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    binary = indices
    views = [{"buffer": 0, "byteLength": len(indices)}]
    accessors = [{"bufferView": 0, "componentType": 5123, "count": 6, "type": "SCALAR"}]
    primitives = []
    for material, quad in enumerate(quads):
        positions = b"".join(struct.pack("<3f", *corner) for corner in quad)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(positions)})
        binary += positions
        low, high = ([choose(axis) for axis in zip(*quad)] for choose in (min, max))
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": 4, "type": "VEC3", "min": low,
                          "max": high})
        primitives.append({"attributes": {"POSITION": len(accessors) - 1}, "indices": 0, "material": material})
    pbr = {"baseColorFactor": [.8, .6, .4, 1], "metallicFactor": 0, "roughnessFactor": .3}
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "name": "room"}, {"translation": [0, 1, 0], "name": "bulb",
                                                "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "meshes": [{"primitives": primitives}],
        "materials": [{"pbrMetallicRoughness": pbr}, {"pbrMetallicRoughness": dict(pbr, roughnessFactor=1)},
                      {"emissiveFactor": [1, 1, 1], "doubleSided": True}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
        "buffers": [{"byteLength": len(binary)}], "bufferViews": views, "accessors": accessors,
    }, binary


def animated(description, binary):
    """The lamp rises in a second; the floor has a texture."""
    description = json.loads(json.dumps(description))

    def add(data, count, kind, **more):
        nonlocal binary
        description["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        description["accessors"].append({"bufferView": len(description["bufferViews"]) - 1, "componentType": 5126,
                                         "count": count, "type": kind, **more})
        binary += data + b"\0" * (-len(data) % 4)
        return len(description["accessors"]) - 1

    times = add(struct.pack("<2f", 0, 1), 2, "SCALAR", min=[0], max=[1])
    places = add(struct.pack("<6f", 0, 1, 0, 0, 2, 0), 2, "VEC3")
    description["animations"] = [{"samplers": [{"input": times, "output": places}],
                                  "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}]
    corners = add(struct.pack("<8f", 0, 0, 1, 0, 1, 1, 0, 1), 4, "VEC2")
    description["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = corners
    picture = png(2, 2, 8, 2, b"\0" + b"\x80" * 6 + b"\0" + b"\xff" * 6)
    description["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(picture)})
    binary += picture
    description["images"] = [{"bufferView": len(description["bufferViews"]) - 1, "mimeType": "image/png"}]
    description["textures"] = [{"source": 0}]
    description["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    description["buffers"][0]["byteLength"] = len(binary)
    return description, binary


def png(width, height, depth, color, rows, interlaced=0):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, interlaced)
    palette = chunk(b"PLTE", bytes(range(12))) if color == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + palette + chunk(b"IDAT", zlib.compress(rows, 9)) +
            chunk(b"IEND", b""))


def hdr(width, height):
    """Runs of a pixel each for the first rows, single pixels for the last."""
    lines = b"".join(b"\2\2" + struct.pack(">H", width) + b"".join(bytes([128 + width, value]) for value in (9, 8, 7, 129))
                     for _ in range(height - 1))
    flat = b"\2\2" + struct.pack(">H", width) + (bytes([width]) + bytes(range(width))) * 4
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + lines + flat


def journal(records):
    data = b"PHATJRNL" + struct.pack("<IIQ", 1, 0, FINGERPRINT)
    for key, payload in records:
        start = struct.pack("<QI", key, len(payload))
        data += start + struct.pack("<I", zlib.crc32(start + payload)) + payload
    return data


def picture_of(path):
    """The bytes of the first image of a GLB."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    description = json.loads(data[20:20 + length])
    view = description["bufferViews"][description["images"][0]["bufferView"]]
    start = 28 + length + view.get("byteOffset", 0)
    return data[start:start + view["byteLength"]]


def run(phat, *arguments):
    subprocess.run([phat, *map(str, arguments), "--quiet"], check=True)


def ies(title, tilt, kind, vertical, horizontal):
    """A photometric file whose intensities are 1, 2, 3 ..."""
    candela = range(1, len(vertical) * len(horizontal) + 1)
    numbers = [f"1 -1 2 {len(vertical)} {len(horizontal)} {kind} 2 .1 .2 0", "1 1.1 9"]
    numbers += [" ".join(map(str, values)) for values in (vertical, horizontal, candela)]
    return "\n".join([title, "[TEST] 1", tilt, *numbers, ""]).encode()


def write_photometric_files():
    (CORPUS / "ies").mkdir(parents=True, exist_ok=True)
    files = {
        "downlight.ies": ies("IESNA:LM-63-2002", "TILT=NONE", 1, range(0, 91, 15), [0]),
        "turned.ies": ies("IES:LM-63-2019", "TILT=NONE", 1, range(0, 181, 45), range(90, 271, 45)),
        "flood.ies": ies("IESNA91", "TILT=NONE", 2, range(-90, 91, 30), range(0, 91, 30)),
        "tilted.ies": ies("a headlamp", "TILT=INCLUDE\n1\n2\n0 90\n1 .9", 3, range(0, 91, 45), [-90, 0, 90]),
    }
    for name, data in files.items():
        (CORPUS / "ies" / name).write_bytes(data)


def main():
    phat = sys.argv[1]
    for folder in ("gltf", "baked", "picture", "journal"):
        (CORPUS / folder).mkdir(parents=True, exist_ok=True)
    scenes = {"room.glb": glb(*room()), "animated.glb": glb(*animated(*room()))}
    for name, data in scenes.items():
        (CORPUS / "gltf" / name).write_bytes(data)
    small = ["--resolution", 64, "--photons", 2000, "--gutter", 1]
    plain = CORPUS / "gltf" / "room.glb"
    run(phat, "bake", plain, "-o", CORPUS / "baked" / "room.phat.glb", "--probes", 8, *small)
    run(phat, "bake", plain, "-o", CORPUS / "baked" / "paper.phat.glb", "--probes", "none", "--storage", "paper",
        "--samples", 2, *small)
    run(phat, "bake", CORPUS / "gltf" / "animated.glb", "-o", CORPUS / "baked" / "photons.phat.glb", "--probes",
        "none", "--directions", "photons", *small)

    pictures = {
        "rgb.png": png(3, 2, 8, 2, (b"\1" + bytes(range(9))) + (b"\4" + bytes(range(9)))),
        "grey16.png": png(2, 2, 16, 0, b"\0\1\2\3\4\2\5\6\7\x08"),
        "palette.png": png(4, 2, 2, 3, b"\0\x1b\0\xe4"),
        "interlaced.png": png(3, 3, 8, 6, b"".join(b"\0" + bytes(4 * width) for width in (1, 1, 2, 1, 1, 3)), interlaced=1),
        "sky.hdr": hdr(8, 3),
        "texture.webp": picture_of(ENCODED / "webp.glb"),
        "texture.avif": picture_of(ENCODED / "avif.glb"),
    }
    for name, data in pictures.items():
        (CORPUS / "picture" / name).write_bytes(data)
    for name in ("room.exr", "room.jpg"):
        run(phat, "render", CORPUS / "gltf" / "room.glb", "-o", CORPUS / "picture" / name, "--method", "path",
            "--spp", 1, "--size", "8x8")

    write_photometric_files()
    part = bytes(range(40))
    (CORPUS / "journal" / "parts.journal").write_bytes(journal([(7, part), (8, b""), (9, part[:3])]))
    (CORPUS / "journal" / "cut.journal").write_bytes(journal([(7, part), (7, part[:8])])[:-5])


if __name__ == "__main__":
    main()
