#!/usr/bin/env python3
"""Checks that dependencies between the folders of src/, and between the layers inside core and io, point one way.

usage: check_includes.py [SRC]     default: src/ beside this script's folder

Prints each offending line as FILE:LINE: REASON; exit code 1 when there is one.
"""

import pathlib
import re
import sys

# What the files of a folder may include of ours.
MAY_INCLUDE = {
    "core": {"core"},
    "io": {"core", "io"},
    "gl": {"core", "gl"},
    "cli": {"core", "io", "gl", "viewer", "cli"},
    "viewer": {"core", "io", "gl", "viewer"},
}

# What the files of a layer may include of its own folder, beside the layer itself.
LAYERS = {
    "core": {
        "base": set(),
        "scene": {"base"},
        "bvh": {"base", "scene"},
        "atlas": {"base", "scene"},
        "transport": {"base", "scene"},
        "phatexel": {"base", "scene", "atlas", "transport"},
        "bake": {"base", "scene", "atlas", "transport", "phatexel"},
        "probes": {"base", "scene", "atlas", "transport", "phatexel", "bake"},
        "render": {"base", "scene", "atlas", "transport", "phatexel", "bake"},
        "dynamic": {"base", "scene", "atlas", "transport", "phatexel", "bake"},
    },
    "io": {
        "base": set(),
        "image": {"base"},
        "ies": {"base"},
        "gltf": {"base", "image", "ies"},
        "phat": {"base", "image", "ies", "gltf"},
    },
}

# Libraries that would let a folder know what it must not: files, pictures and glTF; OpenGL; the command line.
FILES = r"fstream|filesystem|cstdio|Imf\w+\.h|OpenEXR/.*|tiny_gltf\.h|stb_image(_write)?\.h|zlib\.h|nlohmann/.*"
OPENGL = r"epoxy/.*|EGL/.*|GL/.*|GLFW/.*"
COMMAND_LINE = r"CLI/.*"
MUST_NOT_INCLUDE = {
    "core": re.compile(f"({FILES}|{OPENGL}|{COMMAND_LINE})$"),
    "io": re.compile(f"({OPENGL}|{COMMAND_LINE})$"),
    "gl": re.compile(f"({COMMAND_LINE}|Imf\\w+\\.h|OpenEXR/.*|tiny_gltf\\.h)$"),
}

INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')


def complaint(inside, quote, name):
    """Why a file in the folder `inside` (its parts below src/) may not have this include; None if it may."""
    folder = inside[0]
    if quote == "<":
        forbidden = MUST_NOT_INCLUDE.get(folder)
        return f"{folder} must not know <{name}>" if forbidden and forbidden.match(name) else None
    target = name.split("/")
    if target[0] not in MAY_INCLUDE or len(target) == 1:
        return f'write "{name}" as a path from src/'
    if target[0] not in MAY_INCLUDE[folder]:
        return f"{folder} must not depend on {target[0]} ({name})"
    layers = LAYERS.get(target[0])
    if not layers:
        return None
    if len(target) == 2 or target[1] not in layers:
        return f"{target[0]} has no such layer ({name})"
    if folder == target[0] and target[1] != inside[1] and target[1] not in layers[inside[1]]:
        return f"{folder}/{inside[1]} must not depend on {folder}/{target[1]} ({name})"
    return None


def main():
    default = pathlib.Path(__file__).resolve().parent.parent / "src"
    src = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default
    files = sorted(path for path in src.rglob("*") if path.suffix in {".h", ".cpp"})
    if not files:
        print(f"{src}: no source files", file=sys.stderr)
        return 1
    failed = False
    for path in files:
        inside = path.relative_to(src).parent.parts
        if not inside or inside[0] not in MAY_INCLUDE or (
                inside[0] in LAYERS and (len(inside) == 1 or inside[1] not in LAYERS[inside[0]])):
            print(f"{path}:1: no rule for the folder {'/'.join(inside)}", file=sys.stderr)
            failed = True
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            reason = match and complaint(inside, match.group(1), match.group(2))
            if reason:
                print(f"{path}:{number}: {reason}", file=sys.stderr)
                failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
