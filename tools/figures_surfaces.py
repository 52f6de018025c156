"""Glossy surfaces in views: what figures.py and goals.py measure, and their references.

All pictures show the middles of pixels (--pixel-filter center): a single frame without anti-aliasing has no other
places, and eight frames of a still view average only what the estimator draws. The references have the same filter, so
edges and textures do not count as errors. A reference is the path tracer's at some pixels that are scattered over the
surface, with as many samples as its noise needs to stay well below what is measured.
Materials that are changed after the bake see the light of the baked file (--keep-light).
"""

import dataclasses
import math
import statistics

from figures_run import PEERS, PHAT, ROOT, compare

TABLE = "table_top"
ROUGHNESS = (0.15, 0.25, 0.4, 0.6)
SEEDS = (1, 2, 3)
# Side of the table's texels, mm -> flags. The table's density (src/core/atlas/glossy_density.cpp) is 3.59 where it is not held.
TEXELS = {"3.9": ("--texel-size", 0.0117, "--glossy-density", 3), "1.95": ("--texel-size", 0.0070, "--glossy-density", 8)}
CAMERAS = {"file": (), "steep": ((0.3, 2.2, 0.75), (0.0, 0.75, -0.05))}  # eye, target
MATERIALS = {"metal": (), "dielectric": (f"{TABLE}.metallic=0",)}
DEFAULT_TEXELS = "1048576"
DATA = ROOT / "tests/data/references"


@dataclasses.dataclass(frozen=True)
class Surface:
    """A surface in a view, with the bake that it is drawn from."""

    name: str
    scene: str
    size: str
    bake_flags: tuple
    bake_name: str
    view: tuple = ()  # eye, target
    edits: tuple = ()
    mask: str = ""  # of tests/data/references; empty: the material's
    material: str = TABLE

    def where(self):
        """What tells its references from others."""
        return "-".join((self.mask or f"{self.scene}-{self.material}", "steep" if self.view else "file", *self.edits))

    def flags(self):
        edits = sum((("--set", edit) for edit in self.edits), ())
        view = sum(((flag, ",".join(map(str, place))) for flag, place in zip(("--eye", "--target"), self.view)), ())
        return ("--component", "glossy-indirect", "--pixel-filter", "center", "--size", self.size, *view, *edits)


def table_surfaces():
    """tabletop's table in all sizes of texels, views, materials and roughnesses."""
    return [Surface(f"tabletop-{texel}-{camera}-{material}-{roughness}", "tabletop", "480x270", flags, f"tabletop-{texel}mm",
                    view, (*edits, f"{TABLE}.roughness={roughness}"))
            for texel, flags in TEXELS.items() for camera, view in CAMERAS.items()
            for material, edits in MATERIALS.items() for roughness in ROUGHNESS]


def default_bake(scene, texels=DEFAULT_TEXELS):
    """(flags, name)"""
    return ("--resolution", texels), f"{scene}-{texels}"


def scene_surfaces():
    """The others', from bakes with default settings."""
    return [Surface(f"{scene}-{part}", scene, size, *default_bake(scene), mask=f"{mask}.mask-{part}")
            for scene, size, mask, part in (("cornell-glossy", "360x360", "cornell-glossy", "glossy"),
                                            ("gallery", "480x270", "gallery", "floor"), ("gallery", "480x270", "gallery", "curved"))]


@dataclasses.dataclass(frozen=True)
class Reference:
    pixels: int = 1000
    spp: int = 8192


class Surfaces:
    """Bakes, masks and references, made where they are missing."""

    def __init__(self, shop, reference=Reference(), keep_bakes=False):
        self.shop, self.settings, self.keep_bakes = shop, reference, keep_bakes

    def scene(self, surface):
        return ROOT / "scenes" / f"{surface.scene}.glb"

    def bake(self, surface, seed=1):
        """(file, what the bake said)"""
        name = f"{surface.bake_name}-{seed}.phat.glb"
        said = self.shop.make(name, PHAT, "bake", self.scene(surface), *surface.bake_flags, "--seed", seed, "--json", "--quiet",
                              keep=self.keep_bakes)
        return self.shop.path(name), said

    def whole_mask(self, surface, window=None):
        if surface.mask:
            return DATA / f"{surface.mask}.exr"
        name = f"mask-{surface.scene}-{surface.material}-{'steep' if surface.view else 'file'}{'-window' if window else ''}.exr"
        places = sum(((flag, *place) for flag, place in zip(("--eye", "--target"), surface.view)), ())
        self.shop.make(name, PEERS, "mask", self.scene(surface), "--material", surface.material, "--size", surface.size, *places,
                       *(("--window", *window) if window else ()), keep=True)
        return self.shop.path(name)

    def mask(self, surface):
        """The reference's pixels."""
        whole = self.whole_mask(surface)
        thin = f"{whole.stem}-{self.settings.pixels}.exr"
        self.shop.make(thin, PEERS, "thin", whole, "--count", self.settings.pixels, keep=True)
        return self.shop.path(thin)

    def reference(self, surface):
        """(picture, variance, what was said) of `path`; surfaces that differ in the bake alone share it."""
        name = f"reference-{surface.where()}.exr"
        variance = self.shop.path(f"variance-{surface.where()}.exr")
        said = self.shop.make(name, PHAT, "render", self.scene(surface), "--method", "path", *surface.flags(),
                              "--spp", self.settings.spp, "--seed", 11, "--pixels", self.mask(surface), "--variance", variance,
                              *(("--keep-light",) if surface.edits else ()), "--json", "--quiet", keep=True)
        return self.shop.path(name), variance, said

    def draw(self, surface, method, *flags, seed=1, masked=False, name=None):
        """A picture from the bake, or of the scene if the method needs none: (file, what was said)."""
        needs_bake = method.startswith("phat")
        source = self.bake(surface, seed)[0] if needs_bake else self.scene(surface)
        pixels = ("--pixels", self.mask(surface)) if masked else ()
        name = name or f"{surface.name}-{method}-{'-'.join(str(flag).strip('-') for flag in flags)}-{seed}.exr"
        said = self.shop.make(name, PHAT, "render", source, "--method", method, *flags, *surface.flags(), *pixels,
                              *(("--keep-light",) if not needs_bake and surface.edits else ()), "--json", "--quiet")
        return self.shop.path(name), said

    def errors(self, surface, picture):
        """relMse, maeOverMean, bias, noise (the reference's) and clean (MAE/mean without it)."""
        reference, variance, _ = self.reference(surface)
        found = compare(picture, reference, self.mask(surface), variance=variance)
        # Squares of independent errors add up.
        found["clean"] = math.sqrt(max(found["maeOverMean"] ** 2 - found["noise"] ** 2, 0))
        del found["flip"]  # of scattered pixels it means nothing
        return found


def two_sigma(values):
    """Of the mean."""
    return 2 * statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else 0


def with_error(values, form):
    error = f" ± {two_sigma(values):.3f}" if len(values) > 1 else ""
    return f"{statistics.mean(values):{form}}{error}"
