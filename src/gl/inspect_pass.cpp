#include "gl/inspect_pass.h"

#include <algorithm>

namespace phat {

void bindInspection(const ShaderProgram& program, const GpuAtlas& atlas, const RelightPass& relit,
                    const Inspection& inspection) {
    const int source = std::clamp(inspection.source, 0, int(atlas.sources.size()) - 1);
    const GpuPhatexels& phatexels = atlas.sources[size_t(source)];
    program.bind("tileTable", 0, atlas.tileTable.name());
    program.bind("phatexels", 1, atlas.phatexels.name());
    program.bind("tilePatches", 2, atlas.tilePatches.name());
    program.bind("relit", 3, relit.lobes.name());
    program.bind("radii", 4, relit.radii.name());
    program.set("inspected", int(inspection.what));
    program.set("layer", phatexels.firstLayer +
                             std::clamp(inspection.layer, 0, std::max(phatexels.layerCount - 1, 0)));
    program.set("lobeIndex", source);
    program.set("level", std::clamp(inspection.level, 0, kTopLevel));
    program.set("coarsestTexelMeters", atlas.coarsestTexelMeters);
    program.set("unitMeters", atlas.unitMeters);
}

}  // namespace phat
