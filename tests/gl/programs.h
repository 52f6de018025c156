#pragma once
// The programs of the renderer and of the page, each with the variants of its shaders that are longest.

#include <string>
#include <vector>

namespace phat::test {

struct ProgramVariant {
    const char* vertex;
    const char* fragment;
    std::vector<std::string> defines;
};

/// As src/gl and web/src make them, with the page's defines (WITHOUT_PUNCTUAL_LIGHTS) among them.
inline std::vector<ProgramVariant> longestPrograms() {
    const std::vector<std::string> coat = {"AREA", "CLEARCOAT"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), coat.begin(), coat.end());
        return more;
    };
    return {
        {"surface.vert", "lobes.frag", {"CLEARCOAT"}},
        {"surface.vert", "lobes.frag", {"CLEARCOAT", "TRACED"}},
        {"fullscreen.vert", "reflection_guides.frag", coat},
        {"fullscreen.vert", "trace_reflections.frag", with({"BVH_OPACITY", "GLASS"})},
        {"fullscreen.vert", "shade_reflections.frag", with({"SCRAMBLES", "GLASS", "SKY"})},
        {"fullscreen.vert", "trace_lights.frag", with({"BVH_OPACITY", "GLASS"})},
        {"fullscreen.vert", "trace_lights.frag", with({"BVH_OPACITY", "GLASS", "SKY"})},
        {"fullscreen.vert", "shade_reflections.frag",
         with({"SCRAMBLES", "GLASS", "SKY", "WITHOUT_PUNCTUAL_LIGHTS"})},
        {"fullscreen.vert", "trace_hit_lights.frag", with({"BVH_OPACITY", "GLASS"})},
        {"fullscreen.vert", "trace_texels.frag", {"BVH_OPACITY"}},
        {"fullscreen.vert", "light_texels.frag", {"BVH_OPACITY"}},
        {"fullscreen.vert", "pack_phatexels.frag", {}},
        {"fullscreen.vert", "estimate_irradiance.frag", {}},
        {"fullscreen.vert", "filter_irradiance.frag", {"FIRST"}},
        {"fullscreen.vert", "filter_irradiance.frag", {}},
        {"fullscreen.vert", "picture_cells.frag", {}},
        {"fullscreen.vert", "picture_alphas.frag", {}},
        {"fullscreen.vert", "mean_reflections.frag", {}},
        {"fullscreen.vert", "pool_reflections.frag", {}},
        {"fullscreen.vert", "reproject_reflections.frag", {}},
        {"surface.vert", "lookup.frag", with({"SCRAMBLES"})},
        {"surface.vert", "lookup.frag", with({"SCRAMBLES", "COUNT_READS"})},
        {"fullscreen.vert", "pool.frag", coat},
        {"fullscreen.vert", "pool.frag", with({"COUNT_READS"})},
        {"surface.vert", "display.frag", with({"LOOKUP"})},
        {"surface.vert", "display.frag", with({"LOOKUP", "SUN_DISC", "SHADOW_TINTS"})},
        {"surface.vert", "display.frag", with({"SUN_DISC", "SHADOW_TINTS"})},
        {"surface.vert", "display.frag", with({"PAPER", "SUN_DISC", "SHADOW_TINTS"})},
        {"surface.vert", "display.frag", with({"SUN_DISC", "SHADOW_TINTS", "GLASS", "GLASS_TEXTURES"})},
        {"surface.vert", "display.frag",
         with({"PAPER", "SUN_DISC", "SHADOW_TINTS", "GLASS", "GLASS_TEXTURES"})},
        {"surface.vert", "display.frag", with({"LOOKUP", "WITHOUT_PUNCTUAL_LIGHTS", "TRANSMISSION_TEXTURE"})},
        {"surface.vert", "added_surface.frag", {}},
        {"surface.vert", "added_surface.frag", {"SUN_DISC", "SHADOW_TINTS"}},
        {"surface.vert", "preview.frag", {"AREA"}},
        {"surface.vert", "preview.frag", {"AREA", "WITHOUT_PUNCTUAL_LIGHTS"}},
        {"surface.vert", "traced_surfaces.frag", {"CLEARCOAT"}},
        {"surface.vert", "depth.frag", {}},
        {"surface.vert", "shadow_tint.frag", {}},
        {"surface.vert", "inspect.frag", {}},
        {"fullscreen.vert", "relight.frag", with({"TEXEL_PDF"})},
        {"fullscreen.vert", "relight_paper.frag", {"CLEARCOAT"}},
        {"fullscreen.vert", "radius.frag", coat},
        {"fullscreen.vert", "pyramid.frag", {}},
        {"fullscreen.vert", "texel_material.frag", {}},
        {"fullscreen.vert", "trace_rays.frag", {"BVH_OPACITY"}},
        {"fullscreen.vert", "split_sum.frag", {}},
        {"fullscreen.vert", "present.frag", {}},
        {"fullscreen.vert", "background.frag", {}},
        {"fullscreen.vert", "behind.frag", {}},
        {"fullscreen.vert", "accumulate.frag", {}}};
}

}  // namespace phat::test
