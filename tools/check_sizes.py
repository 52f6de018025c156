#!/usr/bin/env python3
"""Sizes that a reader can hold in mind: files of at most 350 lines, functions of 60, 6 parameters.

Reads C++, GLSL and JavaScript of src, shaders and web with Universal Ctags. Prints what is larger, one line each,
and exits with 1 if there is any.

usage: check_sizes.py [ROOT]
"""
import json
import pathlib
import re
import subprocess
import sys

MAX_FILE, MAX_FUNCTION, MAX_PARAMETERS = 350, 60, 6
SUFFIXES = {".cpp", ".h", ".glsl", ".frag", ".vert", ".js"}


def sources(root):
    for folder in ("src", "shaders", "web/src", "web/viewer"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES:
                yield path.relative_to(root)


def parameter_count(signature):
    """Of "(const std::map<int, int>& a, int b)": 2."""
    inner, depth = signature[1:-1], 0
    count = 1 if inner.strip() and inner.strip() != "void" else 0
    for character in inner:
        depth += (character in "<({[") - (character in ">)}]")
        count += character == "," and depth == 0
    return count


def tags(root, files):
    command = ["ctags", "--output-format=json", "--fields=+neS", "--map-C++=+.h.glsl.frag.vert", "--kinds-C++=fp",
               "-f", "-", *map(str, files)]
    output = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    return [json.loads(line) for line in output.splitlines()]


def complaints(root):
    files = list(sources(root))
    for path in files:
        lines = len((root / path).read_text().splitlines())
        if lines > MAX_FILE:
            yield f"{path}: {lines} lines, at most {MAX_FILE}"
    for tag in tags(root, files):
        if tag.get("kind") not in ("function", "prototype", "method"):
            continue
        where = f"{tag['path']}:{tag['line']}: {tag['name']}"
        lines = tag.get("end", tag["line"]) - tag["line"] + 1
        if lines > MAX_FUNCTION:
            yield f"{where} has {lines} lines, at most {MAX_FUNCTION}"
        parameters = parameter_count(re.sub(r"->|=>", "", tag.get("signature", "()")))
        if parameters > MAX_PARAMETERS:
            yield f"{where} has {parameters} parameters, at most {MAX_PARAMETERS}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    found = list(complaints(root))
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
