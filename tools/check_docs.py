#!/usr/bin/env python3
"""Checks that the documents speak of what exists.

usage: check_docs.py [ROOT]     default: the folder above this script's

- Links between files, and paths in backticks, lead to files of the repository.
- Every flag after `phat COMMAND`, and every flag in backticks, is an option of the program.
- Constants: a table row that begins with `kName` and a number gives the value that the source gives; for names that
  have several values in the source, the value in the file that the row names.
- A `twin:` comment names files that exist, and identifiers that these files hold.

Prints each offending line as FILE:LINE: REASON; exit code 1 when there is one.
"""

import pathlib
import re
import sys

DOCUMENTS = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "scenes/*.md"]

# Made by the build or by the reader's own commands.
NOT_STORED = re.compile(r"(build|out)/|.*(room|/share/)|PREFIX/")
# Flags of other programs that the documents mention.
OTHER_FLAGS = {"--preset", "--build", "--target", "--test-dir", "--gtest_filter", "--benchmark_format", "--help", "--version",
               "--install-links", "--exclude", "--install", "--prefix", "--rm"}

LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")
CODE = re.compile(r"`([^`]+)`")
PATH = re.compile(r"^[\w.\-]+(/[\w.\-*]+)+/?$")
FLAG = re.compile(r"(?<![\w-])(--[a-z][a-z_-]*)")
CONSTANT_ROW = re.compile(r"^\| `(k\w+)`([^|]*)\| ([^|]+) \|")
HOME = re.compile(r"`(\w+\.\w+)`")
DEFINITION = re.compile(r"\b(k[A-Z]\w*)(?:\[[^\]]*\])?\s*(?:=|\{)\s*([^;,{}]+?)\s*[;,}]")


SOURCES = {".h", ".cpp", ".glsl", ".frag", ".vert", ".js"}
NAME = r"[A-Za-z_]\w*(?:::\w+)*"
SOURCE_PATH = r"(?:src|shaders|web|tools)/[\w./-]*\.\w+"
NAMES_IN_PATH = re.compile(rf"({NAME}(?: and {NAME})*) in ({SOURCE_PATH})")
PATH_WITH_NAME = re.compile(rf"({SOURCE_PATH}), (?:with )?(k[A-Z]\w*)")
OWN_CONSTANT = re.compile(r"\b(k[A-Z]\w*)\s*=[^/]*//\s*twin:")


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
    """{name: {file's name: {values}}}"""
    values = {}
    for folder in ("src", "shaders"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in {".h", ".cpp", ".glsl", ".frag", ".vert"}:
                continue
            for name, text in DEFINITION.findall(path.read_text(encoding="utf-8")):
                values.setdefault(name, {}).setdefault(path.name, set()).add(number(text))
    return values


def source_flags(root):
    text = "".join(path.read_text(encoding="utf-8") for path in (root / "src").rglob("*.cpp"))
    return {flag for literal in re.findall(r'"([^"\n]*)"', text) for flag in FLAG.findall(literal)}


def twin_complaints(root):
    """(file, line, reason) of each twin: comment that leads nowhere."""
    for folder in ("src", "shaders", "web"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SOURCES or {"node_modules", "dist"} & set(path.parts):
                continue
            lines = path.read_text(encoding="utf-8").splitlines()
            for index, line in enumerate(lines):
                if "twin:" not in line:
                    continue
                text = line.split("twin:")[1]
                # A reference may end in the comment's next line.
                following = lines[index + 1].strip() if index + 1 < len(lines) else ""
                if following.startswith("//") and not text.rstrip().endswith("."):
                    text += " " + following.lstrip("/").strip()
                files = re.findall(SOURCE_PATH, text)
                wanted = [(name, file) for names, file in NAMES_IN_PATH.findall(text) for name in names.split(" and ")]
                wanted += [(name, file) for file, name in PATH_WITH_NAME.findall(text)]
                wanted += [(own.group(1), files[0]) for own in [OWN_CONSTANT.search(line)] if own and files and (root / files[0]).suffix != ".glsl"]
                for file in files:
                    if not (root / file).is_file():
                        yield path.relative_to(root), index + 1, f"there is no {file}"
                for name, file in wanted:
                    if (root / file).is_file() and not re.search(
                            rf"\b{name.split('::')[-1]}\b", (root / file).read_text(encoding="utf-8")):
                        yield path.relative_to(root), index + 1, f"{file} has no {name}"


def value_complaint(name, value, home, files):
    """Why a row may not say that `name` of the file `home` (None: not said) is `value`; None if it may.
    files: {file's name: {values}}."""
    known = {one for values in files.values() for one in values if one is not None}
    if home and home not in files:
        return f"there is no {name} in {home}"
    if home:
        known = {one for one in files[home] if one is not None}
    elif len(known) > 1:
        return f"{name} is {sorted(known)} in {sorted(files)}: name the file after the constant"
    if value is None or None in set().union(*files.values()) or any(abs(one - value) <= 1e-9 * abs(value) for one in known):
        return None
    return f"{name} is {sorted(known)}, not {value:g}"


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
            # A row of several constants gives their values in the same order: the first's is checked.
            name, value = row.group(1), number(row.group(3).split(", ")[0].strip())
            home = HOME.search(row.group(2))
            if name not in constants:
                yield number_of_line, f"there is no constant {name}"
                continue
            reason = value_complaint(name, value, home and home.group(1), constants[name])
            if reason:
                yield number_of_line, reason


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
    for path, line, reason in twin_complaints(root):
        print(f"{path}:{line}: {reason}", file=sys.stderr)
        failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
