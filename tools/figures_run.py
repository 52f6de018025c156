"""Runs the programs for figures.py and keeps what they made, so that a stopped run goes on where it was."""

import json
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PHAT = ROOT / "build/release/phat"
PEERS = ROOT / "build/release/bench/peers/phat_peers"
LIVE = ROOT / "build/release/bench/live/phat_live"
SHADERS = ROOT / "shaders"


class Workshop:
    """A folder of pictures, each beside a record of the command that made it and what the command said."""

    def __init__(self, folder):
        self.folder = folder
        self.started = time.monotonic()
        folder.mkdir(parents=True, exist_ok=True)

    def path(self, name):
        return self.folder / name

    def make(self, name, program, *arguments, keep=False, output=None):
        """Runs `program arguments -o NAME` unless the same command has made it; the command's JSON, or {}.

        Pictures older than the program or its shaders are made anew, but for those to `keep`: references, which
        take long.
        `output`: for commands that make several files of a pattern, NAME being the record's.
        """
        target, record = self.path(name), self.path(name + ".json")
        command = [str(word) for word in arguments] + ["-o", str(output or target)]
        if record.exists():
            old = json.loads(record.read_text())
            fresh = keep or record.stat().st_mtime >= self.changed(program, arguments[0])
            if old["command"] == command and fresh and (output or target.exists()):
                return old["said"]
        self.say(name)
        said = run(program, *command)
        said = json.loads(said) if said.lstrip().startswith(("{", "[")) else {}
        record.write_text(json.dumps({"command": command, "said": said}, indent=1))
        return said

    def changed(self, program, command):
        files = [program, *(SHADERS.rglob("*.*") if command == "render" else ())]
        return max(file.stat().st_mtime for file in files)

    def say(self, text):
        print(f"{time.monotonic() - self.started:6.0f} s  {text}", flush=True)


def run(program, *arguments):
    """What the program prints; a failure ends the script with the program's own words."""
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{pathlib.Path(program).name} {' '.join(map(str, arguments))}\n{done.stderr.strip()}")
    return done.stdout


def compare(picture, reference, mask=None, exposure=0, variance=None):
    """relMse, maeOverMean, bias, flip of a picture; with the reference's variance also the noise that it has."""
    masked = (["--mask", mask] if mask else []) + (["--variance", variance] if variance else [])
    return json.loads(run(PHAT, "compare", picture, reference, *masked, "--exposure", exposure, "--json"))


def table(header, rows):
    """As Markdown."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])
