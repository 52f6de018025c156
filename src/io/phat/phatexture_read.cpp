#include "io/phat/phatexture_read.h"

#include <cmath>

#include "core/phatexel/lookup_tables.h"
#include "io/phat/baked_layout.h"
#include "io/phat/paper_storage.h"

namespace phat {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const char* reason) {
    throw std::runtime_error(reason);
}

std::vector<PackedPhatexel> readTexels(PayloadReader& reader, const json& layer, PhatexelStorage storage,
                                       uint64_t count) {
    if (storage == PhatexelStorage::paper)
        return packedOfPaper(readPayload<PackedPhatexel16>(reader, layer, "phatexels", count));
    const auto radiance = readPayload<uint32_t>(reader, layer, "radiance", count);
    const auto direction = readPayload<uint32_t>(reader, layer, "direction", count);
    std::vector<PackedPhatexel> texels(count);
    for (size_t i = 0; i < count; ++i) texels[i] = {radiance[i], direction[i]};
    return texels;
}

void checkPlaces(const std::vector<PackedPhatexel>& texels, const Atlas& atlas) {
    for (size_t i = 0; i < texels.size(); ++i) {
        if (texels[i].directionDistance == 0 && texels[i].radiance == 0) continue;
        if (atlas.chartAt({i % atlas.sizeTexels.x, i / atlas.sizeTexels.x}) == kNoChart)
            refuse("a PHATexel lies on a tile that has no chart");
    }
}

void readLayers(PayloadReader& reader, const json& object, PhatexelStorage storage, const Atlas& atlas,
                std::vector<PhatexelLayer>& layers, std::vector<Guide>& guides) {
    const uint64_t guideCount = wholeNumber(object, "guideCount");
    if (guideCount > 1 && guideCount != atlas.blockCount) refuse("the guides are not one for each block");
    if (guideCount > 0) guides = readPayload<Guide>(reader, object, "guides", guideCount);
    for (const Guide& guide : guides)
        for (const uint16_t weight : guide.weight)
            if (weight == 0) refuse("a guide has a cell without weight");
    const json& described = object.at("layers");
    if (!described.is_array()) refuse("\"layers\" is not an array");
    for (const json& item : described) {
        PhatexelLayer& layer = layers.emplace_back();
        layer.texels = readTexels(reader, item, storage, atlas.texelCount());
        checkPlaces(layer.texels, atlas);
        if (item.contains("pdf"))
            layer.pdf = readPayload<float>(reader, item, "pdf", atlas.texelCount());
        else if (guides.empty())
            refuse("a layer has neither guides nor densities");
        for (const float pdf : layer.pdf)
            if (!(pdf >= 0 && std::isfinite(pdf))) refuse("a density is not a number");
        if (item.contains("scrambles"))
            layer.scrambles = readPayload<uint16_t>(reader, item, "scrambles", atlas.blockCount);
    }
}

void readTiles(PayloadReader& reader, const json& object, const Atlas& atlas, Phatexture& phatexture) {
    const uint64_t tiles = atlas.tileChart.size();
    phatexture.tilePatches = readPayload<PackedTile>(reader, object, "places", tiles);
    if (object.contains("distances")) {
        const auto levels = readPayload<LevelsRecord>(reader, object, "distances", tiles);
        for (size_t i = 0; i < tiles; ++i)
            phatexture.probes.push_back(unpackProbe(levels[i], phatexture.tilePatches[i]));
    } else if (canLookUp(phatexture.indirect, phatexture.indirectGuides)) {
        refuse("the distances around the tiles are missing");
    }
    readPayload<glm::vec3>(reader, object, "brightest",
                           tiles);  // the renderer makes its own, with more in it
}

}  // namespace

Phatexture readPhatexture(PayloadReader& reader, const json& extension, PhatexelStorage storage,
                          const Atlas& atlas) {
    Phatexture phatexture;
    const json& indirect = extension.at("indirect");
    readLayers(reader, indirect, storage, atlas, phatexture.indirect, phatexture.indirectGuides);
    phatexture.indirectIrradiance = readPayload<uint32_t>(reader, indirect, "irradiance", atlas.texelCount());
    const json& area = extension.at("area");
    readLayers(reader, area, storage, atlas, phatexture.area, phatexture.areaGuides);
    if (phatexture.area.size() > 1) refuse("there is more than one layer of area light");
    if (area.contains("irradiance"))
        phatexture.areaIrradiance = readPayload<uint32_t>(reader, area, "irradiance", atlas.texelCount());
    readTiles(reader, extension.at("tiles"), atlas, phatexture);
    return phatexture;
}

}  // namespace phat
