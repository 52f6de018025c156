#!/usr/bin/env python3
"""Gives scenes/tabletop.glb an animation: the globe rolls over the table, the lamp swings.

usage: animate_tabletop.py [IN [OUT]]     default: scenes/tabletop.glb scenes/tabletop-animated.glb
"""

import json
import math
import pathlib
import struct
import sys

SECONDS = 6
KEYS = 49  # 8 a second
GLOBE_RADIUS = 0.22  # metres
GLOBE_WAY = (0.38, 0.6)  # metres along x and z, there and back: between cone and edge
LAMP_ANGLE = 0.12    # radians
CEILING = 2.75       # metres: where the lamp hangs from


def multiply(a, b):
    """Product of quaternions x, y, z, w."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz]


def about(axis, angle):
    return [*(math.sin(angle / 2) * a for a in axis), math.cos(angle / 2)]


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    source = sys.argv[1] if len(sys.argv) > 1 else root / "scenes/tabletop.glb"
    target = sys.argv[2] if len(sys.argv) > 2 else root / "scenes/tabletop-animated.glb"
    data = pathlib.Path(source).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf = json.loads(data[20:20 + length])
    binary = bytearray(data[28 + length:])

    def accessor(rows):
        while len(binary) % 4:
            binary.append(0)
        gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * len(rows) * len(rows[0])})
        for row in rows:
            binary.extend(struct.pack(f"<{len(row)}f", *row))
        made = {"bufferView": len(gltf["bufferViews"]) - 1, "componentType": 5126, "count": len(rows),
                "type": {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[len(rows[0])]}
        if len(rows[0]) == 1:
            made["min"], made["max"] = [rows[0][0]], [rows[-1][0]]
        gltf["accessors"].append(made)
        return len(gltf["accessors"]) - 1

    index = {node["name"]: i for i, node in enumerate(gltf["nodes"])}
    globe, lamp = gltf["nodes"][index["globe"]], gltf["nodes"][index["lamp"]]
    times, places, turns, lamp_places, lamp_turns = [], [], [], [], []
    length = math.hypot(*GLOBE_WAY)
    axis = (GLOBE_WAY[1] / length, 0, -GLOBE_WAY[0] / length)
    for key in range(KEYS):
        seconds = SECONDS * key / (KEYS - 1)
        phase = 2 * math.pi * seconds / SECONDS
        share = 0.5 * (1 - math.cos(phase))
        swing = LAMP_ANGLE * math.sin(2 * phase)
        x, y, z = globe["translation"]
        times.append([seconds])
        places.append([x + share * GLOBE_WAY[0], y, z + share * GLOBE_WAY[1]])
        turns.append(multiply(about(axis, share * length / GLOBE_RADIUS), globe["rotation"]))
        x, y, z = lamp["translation"]
        drop = CEILING - y
        lamp_places.append([x + drop * math.sin(swing), CEILING - drop * math.cos(swing), z])
        lamp_turns.append(about((0, 0, 1), swing))

    clock = accessor(times)
    samplers, channels = [], []
    for name, path, rows in [("globe", "translation", places), ("globe", "rotation", turns),
                             ("lamp", "translation", lamp_places), ("lamp", "rotation", lamp_turns)]:
        samplers.append({"input": clock, "output": accessor(rows), "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": index[name], "path": path}})
    gltf["animations"] = [{"name": "roll and swing", "samplers": samplers, "channels": channels}]

    while len(binary) % 4:
        binary.append(0)
    gltf["buffers"][0]["byteLength"] = len(binary)
    text = json.dumps(gltf, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    out = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(binary))
    out += struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    pathlib.Path(target).write_bytes(out)


if __name__ == "__main__":
    main()
