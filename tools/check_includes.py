#!/usr/bin/env python3
"""Checks that dependencies between the folders of src/ point one way.

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


def complaint(folder, quote, name):
    """Why a file of `folder` may not have this include; None if it may."""
    if quote == "<":
        forbidden = MUST_NOT_INCLUDE.get(folder)
        return f"{folder} must not know <{name}>" if forbidden and forbidden.match(name) else None
    target = name.split("/")[0]
    if target not in MAY_INCLUDE or "/" not in name:
        return f'write "{name}" as a path from src/'
    return None if target in MAY_INCLUDE[folder] else f"{folder} must not depend on {target} ({name})"


def main():
    default = pathlib.Path(__file__).resolve().parent.parent / "src"
    src = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default
    files = sorted(path for path in src.rglob("*") if path.suffix in {".h", ".cpp"})
    if not files:
        print(f"{src}: no source files", file=sys.stderr)
        return 1
    failed = False
    for path in files:
        folder = path.relative_to(src).parts[0]
        if folder not in MAY_INCLUDE:
            print(f"{path}:1: no rule for the folder {folder}", file=sys.stderr)
            failed = True
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            reason = match and complaint(folder, match.group(1), match.group(2))
            if reason:
                print(f"{path}:{number}: {reason}", file=sys.stderr)
                failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
