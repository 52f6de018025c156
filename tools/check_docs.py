#!/usr/bin/env python3
"""Checks that the documents speak of what exists.

usage: check_docs.py [ROOT]     default: the folder above this script's

- Links between files, and paths in backticks, lead to files of the repository.
- Every flag after `phat COMMAND`, and every flag in backticks, is an option of the program.
- Constants: a table row that begins with `kName` and a number gives the value that the source gives.

Prints each offending line as FILE:LINE: REASON; exit code 1 when there is one.
"""

import pathlib
import re
import sys

DOCUMENTS = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "scenes/*.md"]

# Made by the build or by the reader's own commands.
NOT_STORED = re.compile(r"(build|out)/|.*(room|/share/)|PREFIX/")
# Flags of other programs that the documents mention.
OTHER_FLAGS = {"--preset", "--build", "--target", "--test-dir", "--gtest_filter", "--benchmark_format", "--help", "--version"}

LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
CODE = re.compile(r"`([^`]+)`")
PATH = re.compile(r"^[\w.\-]+(/[\w.\-*]+)+/?$")
FLAG = re.compile(r"(?<![\w-])(--[a-z][a-z_-]*)")
CONSTANT_ROW = re.compile(r"^\| `(k\w+)`[^|]*\| ([^|]+) \|")
DEFINITION = re.compile(r"\b(k[A-Z]\w*)(?:\[[^\]]*\])?\s*(?:=|\{)\s*([^;,{}]+?)\s*[;,}]")


def number(text):
    """The value of a literal or of a product, quotient or shift of literals; None if it is anything else."""
    plain = re.sub(r"(?<=[\d.])[fu]\b", "", text.strip().replace("'", "")).replace(" ", "")
    if not re.fullmatch(r"[\d.e+\-*/<()]+", plain):
        return None
    try:
        return float(eval(plain, {"__builtins__": {}}))  # digits and operators only
    except (SyntaxError, ZeroDivisionError, TypeError):
        return None


def source_constants(root):
    values = {}
    for folder in ("src", "shaders"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in {".h", ".cpp", ".glsl", ".frag", ".vert"}:
                continue
            for name, text in DEFINITION.findall(path.read_text(encoding="utf-8")):
                values.setdefault(name, set()).add(number(text))
    return values


def source_flags(root):
    text = "".join(path.read_text(encoding="utf-8") for path in (root / "src").rglob("*.cpp"))
    return {flag for literal in re.findall(r'"([^"\n]*)"', text) for flag in FLAG.findall(literal)}


def exists(root, document, name):
    for base in (root, document.parent, root / "src"):
        if any(base.glob(name.rstrip("/"))):
            return True
    return False


def complaints(root, document, constants, flags):
    in_block = False
    for number_of_line, line in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```"):
            in_block = not in_block
            continue
        codes = [line] if in_block else CODE.findall(line)
        for target in [] if in_block else LINK.findall(line):
            if "://" not in target and not exists(root, document, target):
                yield number_of_line, f"there is no {target}"
        for code in codes:
            for word in code.split():
                known = NOT_STORED.match(word) or exists(root, document, word) if PATH.match(word) else True
                # A path has a folder of ours in front; anything else with a slash is a fraction or a name.
                ours = word.split("/")[0] in {"src", "shaders", "tests", "tools", "docs", "scenes", "bench", "core", "io", "gl", "cli"}
                if ours and not known:
                    yield number_of_line, f"there is no {word}"
            for flag in FLAG.findall(code):
                if flag not in flags and flag not in OTHER_FLAGS:
                    yield number_of_line, f"phat has no option {flag}"
        row = CONSTANT_ROW.match(line)
        if row:
            name, value = row.group(1), number(row.group(2).strip())
            if name not in constants:
                yield number_of_line, f"there is no constant {name}"
            elif value is not None and not any(v is not None and abs(v - value) <= 1e-9 * abs(value) for v in constants[name]):
                yield number_of_line, f"{name} is {sorted(v for v in constants[name] if v is not None)}, not {value:g}"


def main():
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    documents = [path for pattern in DOCUMENTS for path in sorted(root.glob(pattern))]
    if not documents:
        print(f"{root}: no documents", file=sys.stderr)
        return 1
    constants, flags = source_constants(root), source_flags(root)
    failed = False
    for document in documents:
        for line, reason in complaints(root, document, constants, flags):
            print(f"{document.relative_to(root)}:{line}: {reason}", file=sys.stderr)
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
