#include "io/gltf/gltf_problem.h"

#include <fmt/core.h>

#include "io/base/printable.h"

namespace phat::gltf {

void MemoryBudget::charge(uint64_t bytes, const std::string& what) {
    if (bytes > left()) {
        throw Problem(fmt::format("{} would need {} MB of memory, out of proportion to the file's size", what,
                                  (bytes >> 20) + (used_ >> 20)));
    }
    used_ += bytes;
}

std::vector<std::string> linesOf(const Notes& notes) {
    std::vector<std::string> lines = notes.lines;
    const auto add = [&](uint64_t count, const char* one, const char* many) {
        if (count > 0) lines.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
    };
    add(notes.pointAndLinePrimitives, "primitive of points or lines was skipped: it has no surface",
        "primitives of points or lines were skipped: they have no surface");
    add(notes.primitivesWithoutPositions, "primitive without positions was skipped",
        "primitives without positions were skipped");
    add(notes.skinnedMeshes, "skinned mesh is shown in the pose of the file",
        "skinned meshes are shown in the pose of the file");
    add(notes.morphedMeshes, "mesh with morph targets is shown with the weights of the file",
        "meshes with morph targets are shown with the weights of the file");
    add(notes.basisFallbacks, "KTX2 texture is drawn from the PNG or JPEG beside it",
        "KTX2 textures are drawn from the PNG or JPEG beside them");
    add(notes.incompleteTriangles, "triangle at the end of an index list was incomplete and is left out",
        "triangles at the ends of index lists were incomplete and are left out");
    add(notes.unplaceableTriangles, "triangle was dropped: its positions are not finite or too far away",
        "triangles were dropped: their positions are not finite or too far away");
    add(notes.repairedNormals, "vertex normal was not usable and is computed from the triangles",
        "vertex normals were not usable and are computed from the triangles");
    add(notes.turnedNormals, "primitive has normals that point behind its triangles: they are turned",
        "primitives have normals that point behind their triangles: they are turned");
    add(notes.repairedTangents, "vertex tangent was not usable and is replaced",
        "vertex tangents were not usable and are replaced");
    add(notes.repairedUvs, "texture coordinate was not usable and is set to 0",
        "texture coordinates were not usable and are set to 0");
    add(notes.repairedColors, "vertex colour was not a number and is set to white",
        "vertex colours were not numbers and are set to white");
    add(notes.clampedFactors, "material factor was outside its legal range and is clamped",
        "material factors were outside their legal range and are clamped");
    for (std::string& line : lines) line = printable(std::move(line), kShownBytes);
    return lines;
}

}  // namespace phat::gltf
