"""How much pictures change while the camera moves, and how soon after a turn they are as good as at rest."""

import json
import math
import statistics
import struct

from figures_run import PEERS, PHAT, ROOT, compare
from figures_surfaces import TABLE, Surface

SIZE = "320x180"
PAN_DEGREES, DOLLY_METERS = 6.0, 0.2
TURN_DEGREES, TURN_FRAMES, REST_FRAMES = 30.0, 4, 24
# Pixels in the middle of the table, which show it in all frames.
WINDOW = (195, 105, 70, 25)
PIXELS = 300
METHODS = {
    "path": ("path",),
    "phat": ("phat", "--trace", "cpu"),
    "lookup alone": ("phat", "--reflections", "lookup"),
    "GPU rays, each frame alone": ("phat", "--trace", "gpu"),
    "GPU rays": ("phat", "--follow"),
    "phat-pyramid": ("phat-pyramid",),
}
# What a turn is measured with.
TURNED = ("GPU rays, each frame alone", "GPU rays")


def moved(node, degrees, meters):
    """A camera's node, turned about the vertical and moved along its own view."""
    x, y, z, w = node["rotation"]
    s, c = math.sin(math.radians(degrees) / 2), math.cos(math.radians(degrees) / 2)
    x, y, z, w = c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y
    forward = (-2 * (x * z + w * y), -2 * (y * z - w * x), 2 * (x * x + y * y) - 1)
    place = [at + meters * along for at, along in zip(node.get("translation", (0, 0, 0)), forward)]
    return {**node, "rotation": [x, y, z, w], "translation": place}


def with_cameras(source, target, moves):
    """A copy of a .glb that has one camera for each (degrees, metres), as its first camera moves."""
    data = source.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    scene = json.loads(data[20:20 + length])
    index, node = next((i, node) for i, node in enumerate(scene["nodes"]) if "camera" in node)
    camera = scene["cameras"][node["camera"]]
    for one in scene["nodes"]:
        one.pop("camera", None)
    scene["cameras"] = [{**camera, "name": f"frame{i:04d}"} for i in range(len(moves))]
    roots = next(one["nodes"] for one in scene["scenes"] if index in one["nodes"])
    for i, move in enumerate(moves):
        roots.append(len(scene["nodes"]))
        scene["nodes"].append({**moved(node, *move), "name": f"frame{i:04d}", "camera": i})
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    target.write_bytes(struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest)


class Film:
    """Frames of tabletop's table, glossy indirect light alone, one sample each."""

    def __init__(self, figures, name, moves):
        self.figures, self.name, self.moves = figures, name, moves

    def mask(self):
        shop = self.figures.shop
        mask, thin = shop.path("motion-mask.exr"), shop.path("motion-thin.exr")
        shop.make(mask.name, PEERS, "mask", ROOT / "scenes/tabletop.glb", "--material", TABLE, "--size", SIZE, "--window",
                  *WINDOW, keep=True)
        shop.make(thin.name, PEERS, "thin", mask, "--count", PIXELS, keep=True)
        return thin

    def frames(self, label):
        shop, (method, *flags) = self.figures.shop, METHODS[label]
        baked = method != "path"
        stem = f"{self.name}-{'-'.join(label.lower().replace(',', '').split())}"
        scene = shop.path(f"{stem}.glb")
        with_cameras(self.figures.bake()[0] if baked else ROOT / "scenes/tabletop.glb", scene, self.moves)
        spp = 1 if baked else self.figures.plan.pan_spp
        flags += [] if baked else ["--pixels", self.mask()]
        shop.make(f"{stem}.json", PHAT, "render", scene, "--method", method, *flags, "--camera", "all", "--size", SIZE,
                  "--component", "glossy-indirect", "--pixel-filter", "center", "--spp", spp, "--json", "--quiet",
                  keep=not baked, output=shop.path(f"{stem}.exr"))
        return sorted(shop.folder.glob(f"{stem}.frame*.exr"))[:len(self.moves)]


def steadiness(film):
    """{method: {mean, worst}}: change from frame to frame over the mean at fixed pixels."""
    result = {}
    for label in METHODS:
        frames = film.frames(label)
        changes = [compare(b, a, film.mask())["maeOverMean"] for a, b in zip(frames, frames[1:])]
        result[label] = {"mean": statistics.mean(changes), "worst": max(changes)}
    return result


def lag(figures):
    """{method: {settled, frames}}: the error of a view at rest after a fast turn (mean of its last eight frames), and
    after how many frames it is within a tenth of that."""
    turn = [(-TURN_DEGREES * (1 - i / TURN_FRAMES), 0) for i in range(TURN_FRAMES + 1)]
    film = Film(figures, "turn", turn + [(0, 0)] * REST_FRAMES)
    reference = Film(figures, "turned", [(0, 0)]).frames("path")[0]
    result = {}
    for label in TURNED:
        errors = [compare(frame, reference, film.mask())["maeOverMean"] for frame in film.frames(label)[TURN_FRAMES:]]
        settled = statistics.mean(errors[-8:])
        late = [i + 1 for i, error in enumerate(errors) if error > 1.1 * settled]
        result[label] = {"settled": settled, "first": errors[0], "frames": max(late, default=0)}
    return result


def motion(figures):
    """{frames, degrees, meters, turnDegrees, spp, pan: steadiness(), dolly: steadiness(), lag: lag()}"""
    count = figures.plan.pan_frames
    along = [i / (count - 1) - 0.5 for i in range(count)]
    return {"frames": count, "degrees": PAN_DEGREES, "meters": DOLLY_METERS, "turnDegrees": TURN_DEGREES,
            "turnFrames": TURN_FRAMES, "spp": figures.plan.pan_spp,
            "pan": steadiness(Film(figures, "pan", [(PAN_DEGREES * t, 0) for t in along])),
            "dolly": steadiness(Film(figures, "dolly", [(0, DOLLY_METERS * t) for t in along])), "lag": lag(figures)}
