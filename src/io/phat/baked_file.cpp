#include "io/phat/baked_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <nlohmann/json.hpp>
#include <set>

#include "core/phatexel/radiance_bound.h"
#include "io/base/atomic_file.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_light_profiles.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_layout.h"
#include "io/phat/paper_storage.h"
#include "io/phat/phat_payload.h"
#include "io/phat/probes_payload.h"
#include "io/phat/scene_lighting.h"

namespace phat {
namespace {

using nlohmann::json;

// Arrays that wait for compression, and where in the extension their description goes.
struct PendingPayload {
    std::string where;  // JSON pointer
    std::vector<uint8_t> bytes;
};
using Payloads = std::vector<PendingPayload>;

template <class T>
void add(Payloads& payloads, std::string where, const std::vector<T>& values) {
    const auto bytes = bytesOf(values);
    payloads.push_back({std::move(where), {bytes.begin(), bytes.end()}});
}

void addAtlas(Payloads& payloads, const Atlas& atlas, const TexelPoints& points, json& extension) {
    extension["atlas"] = {{"size", {atlas.sizeTexels.x, atlas.sizeTexels.y}},
                          {"texelSize", atlas.texelSizeMeters},
                          {"chartCount", atlas.charts.size()}};
    std::vector<ChartRecord> records;
    for (const Chart& chart : atlas.charts)
        records.push_back({chart.originTile.x, chart.originTile.y, chart.sizeTiles.x, chart.sizeTiles.y,
                           chart.surface, chart.back, chart.otherSide, chart.texelSizeMeters});
    add(payloads, "/atlas/charts", records);
    add(payloads, "/atlas/tiles", atlas.tileChart);
    add(payloads, "/atlas/triangles", atlas.triangleChart);

    std::vector<uint8_t> occluded((points.state.size() + 7) / 8);
    for (size_t i = 0; i < points.state.size(); ++i)
        if (points.state[i] == TexelState::occluded) occluded[i / 8] |= uint8_t(1 << i % 8);
    add(payloads, "/atlas/covered", occluded);
}

// How far the coordinates that a reader computes from the UV set are from those that were baked.
void addTexelCorrection(Payloads& payloads, const Atlas& atlas, json& extension) {
    std::vector<int8_t> correction;
    uLong checksum = crc32(0, nullptr, 0);
    for (const auto& triangle : atlas.triangleTexels) {
        for (const glm::vec2& corner : triangle) {
            const glm::vec2 texel = corner + 0.0f;  // -0 becomes 0
            const glm::vec2 computed = texelFromUv(uvFromTexel(texel, atlas.sizeTexels), atlas.sizeTexels);
            for (int axis = 0; axis < 2; ++axis) {
                const int32_t ulps = ulpsBetween(computed[axis], texel[axis]);
                assert(std::abs(ulps) <= 2);  // two roundings, each of half a unit of either binade
                correction.push_back(int8_t(ulps));
            }
            checksum = crc32(checksum, reinterpret_cast<const Bytef*>(&texel), sizeof(texel));
        }
    }
    extension["atlas"]["texelChecksum"] = uint32_t(checksum);
    if (std::any_of(correction.begin(), correction.end(), [](int8_t ulps) { return ulps != 0; }))
        add(payloads, "/atlas/texelCorrection", correction);
}

void addTexels(Payloads& payloads, const std::string& layer, const std::vector<PackedPhatexel>& texels,
               PhatexelStorage storage) {
    if (storage == PhatexelStorage::paper) return add(payloads, layer + "/phatexels", paperOfPacked(texels));
    std::vector<uint32_t> radiance, direction;
    for (const PackedPhatexel& texel : texels) {
        radiance.push_back(texel.radiance);
        direction.push_back(texel.directionDistance);
    }
    add(payloads, layer + "/radiance", radiance);
    add(payloads, layer + "/direction", direction);
}

void addLayers(Payloads& payloads, const std::string& where, const std::vector<PhatexelLayer>& layers,
               const std::vector<Guide>& guides, PhatexelStorage storage, json& extension) {
    const auto pointer = json::json_pointer(where);
    extension[pointer]["guideCount"] = guides.size();
    extension[pointer]["layers"] = json::array();
    if (!guides.empty()) add(payloads, where + "/guides", guides);
    for (size_t i = 0; i < layers.size(); ++i) {
        const std::string layer = where + "/layers/" + std::to_string(i);
        addTexels(payloads, layer, layers[i].texels, storage);
        if (!layers[i].pdf.empty()) add(payloads, layer + "/pdf", layers[i].pdf);
        if (!layers[i].scrambles.empty()) add(payloads, layer + "/scrambles", layers[i].scrambles);
    }
}

// What a renderer reads by the tile. tileLight follows from the rest; the browser is spared the way there.
void addTiles(Payloads& payloads, const Scene& scene, const Bake& bake) {
    add(payloads, "/tiles/places", bake.phatexture.tilePatches);
    std::vector<LevelsRecord> levels;
    for (const DepthProbe& probe : bake.phatexture.probes) levels.push_back(packLevels(probe));
    if (!levels.empty()) add(payloads, "/tiles/distances", levels);
    std::vector<glm::vec3> brightest;
    for (const glm::vec4& light : tileLight(scene, bake.atlas, bake.phatexture)) brightest.push_back(light);
    add(payloads, "/tiles/brightest", brightest);
}

// Trees for rays in shaders, which take longer to build than to read.
void addBvh(Payloads& payloads, const Scene& scene, json& extension) {
    if (!canHaveBvh(scene)) return;
    const SceneBvh bvh = buildSceneBvh(scene);
    extension["bvh"]["nodeCount"] = bvh.nodes.size();
    add(payloads, "/bvh/nodes", bvh.nodes);
    add(payloads, "/bvh/order", bvh.order);
}

void addProbes(Payloads& payloads, const LightProbes& probes, json& extension) {
    extension["probes"] = describeProbes(probes);
    add(payloads, "/probes/cells", probes.cells);
    add(payloads, "/probes/places", probes.places);
    add(payloads, "/probes/indirect", probes.indirect);
    if (!probes.area.empty()) add(payloads, "/probes/area", probes.area);
    add(payloads, "/probes/distances", probes.distances);
}

void addEnvironment(Payloads& payloads, const Environment& environment, json& extension) {
    constexpr float kLargestRgb9e5 = 65408;
    float largest = 0;
    for (const glm::vec3& pixel : environment.radiance.pixels)
        largest = std::max(largest, maxComponent(pixel));
    // The sun of a photographed sky is brighter than the format reaches.
    const float scale = std::max(1.0f, largest / kLargestRgb9e5);
    std::vector<uint32_t> packed;
    for (const glm::vec3& pixel : environment.radiance.pixels) packed.push_back(packRgb9e5(pixel / scale));
    extension["environment"] = {{"size", {environment.radiance.width, environment.radiance.height}},
                                {"scale", scale}};
    add(payloads, "/environment/radiance", packed);
}

// The webs that the lamps' photometric files come down to: the browser is spared reading these. `gltf` has
// the scene's nodes as they are written.
void addPhotometries(Payloads& payloads, const Scene& scene, const json& gltf, json& extension) {
    std::set<size_t> written;
    for (const PunctualLight& light : scene.lights) {
        if (!light.photometry) continue;
        const auto profile = gltf.at("nodes")
                                 .at(light.node)
                                 .at("extensions")
                                 .at(gltf::kLightProfiles)
                                 .at("light")
                                 .get<size_t>();
        if (!written.insert(profile).second) continue;
        const PhotometricWeb& web = light.photometry->web();
        const std::string where = fmt::format("/photometries/{}/relative", extension["photometries"].size());
        extension["photometries"].push_back({{"light", profile},
                                             {"peakCandela", web.peakCandela},
                                             {"solidAngle", light.photometry->solidAngle()},
                                             {"steps", {web.verticalSteps, web.horizontalSteps}}});
        add(payloads, where, web.relative);
    }
}

void appendPayloads(const Payloads& payloads, json& extension, GlbBuilder& glb, Progress* progress) {
    std::vector<std::vector<uint8_t>> streams(payloads.size());
    tbb::parallel_for(size_t(0), payloads.size(), [&](size_t i) {
        streams[i] = encodePayload(payloads[i].bytes, progress);
        if (progress) progress->advance(payloads[i].bytes.size());
    });
    for (size_t i = 0; i < payloads.size(); ++i)
        extension[json::json_pointer(payloads[i].where)] = {{"bufferView", appendBufferView(glb, streams[i])},
                                                            {"byteLength", payloads[i].bytes.size()}};
}

// Whether a chart has pieces of several surfaces.
bool sharesCharts(const Atlas& atlas) {
    for (size_t t = 0; t < atlas.triangleChart.size(); ++t)
        if (atlas.triangleChart[t] != kNoChart &&
            atlas.charts[atlas.triangleChart[t]].surface != atlas.triangleSurface[t])
            return true;
    return false;
}

std::vector<uint8_t> bakedBytes(const GltfSource& source, const Scene& scene, const Bake& bake,
                                const BakeRecord& record, const BakedFileOptions& options,
                                std::vector<std::string>& notes) {
    Progress* progress = options.progress;
    RewrittenGltf gltf = rewriteGltf(source, scene, bake.atlas);
    notes = gltf.notes;
    writeAddedLights(scene, gltf.glb.json);

    json extension = {
        {"version", kBakedFormatVersion}, {"texCoord", gltf.texCoord}, {"lengthUnit", bake.atlas.unitMeters}};
    if (record.storage != PhatexelStorage::packed) {
        extension["version"] = kStorageFormatVersion;
        extension["storage"] = nameOf(storageNames(), record.storage);
    }
    if (sharesCharts(bake.atlas)) extension["version"] = kSharedChartsFormatVersion;
    extension["record"] = {{"generator", record.generator},
                           {"input", record.source},
                           {"settings", record.settings},
                           {"seed", record.seed}};
    if (options.inputs) extension["inputs"] = describeInputs(*options.inputs);
    for (const Surface& surface : scene.surfaces)
        extension["surfaces"].push_back({{"node", surface.node}, {"primitive", surface.primitive}});
    Payloads payloads;
    addAtlas(payloads, bake.atlas, bake.points, extension);
    addTexelCorrection(payloads, bake.atlas, extension);
    const Phatexture& phatexture = bake.phatexture;
    addLayers(payloads, "/indirect", phatexture.indirect, phatexture.indirectGuides, record.storage,
              extension);
    if (!phatexture.indirectIrradiance.empty())
        add(payloads, "/indirect/irradiance", phatexture.indirectIrradiance);
    addLayers(payloads, "/area", phatexture.area, phatexture.areaGuides, record.storage, extension);
    if (!phatexture.areaIrradiance.empty()) add(payloads, "/area/irradiance", phatexture.areaIrradiance);
    addTiles(payloads, scene, bake);
    addBvh(payloads, scene, extension);
    if (options.probes && options.probes->count() > 0) addProbes(payloads, *options.probes, extension);
    if (scene.environment) addEnvironment(payloads, *scene.environment, extension);
    addPhotometries(payloads, scene, gltf.glb.json, extension);

    uint64_t byteCount = 0;
    for (const PendingPayload& payload : payloads) byteCount += payload.bytes.size();
    if (progress) progress->begin("compress", byteCount);
    appendPayloads(payloads, extension, gltf.glb, progress);
    if (progress) progress->end();

    gltf.glb.json["extensions"][kPhatExtension] = std::move(extension);
    gltf.glb.json["extensionsUsed"].push_back(kPhatExtension);
    return glbBytes(gltf.glb);
}

}  // namespace

FileTooLarge::FileTooLarge(const std::string& file, uint64_t size)
    : FileError(file, fmt::format("would have {:.1f} MB", double(size) * 1e-6)), bytes(size) {}

uint64_t texelsThatFit(uint64_t bytes, uint64_t sceneBytes, int layers, bool areaLights,
                       PhatexelStorage storage) {
    // Compressed bytes a texel, measured on tabletop: irradiance and tiles; a layer; the area lights' share.
    constexpr double kBase = 2.4, kLayer = 7.3, kArea = 4.6, kPaperLayer = 9.1, kPaperArea = 5.1;
    const bool paper = storage == PhatexelStorage::paper;
    const double layer = paper ? kPaperLayer : kLayer, area = paper ? kPaperArea : kArea;
    const double left = double(bytes) - double(sceneBytes);
    return uint64_t(std::max(0.0, left / (kBase + layer * layers + (areaLights ? area : 0.0))));
}

std::vector<std::string> writeBakedFile(const std::string& outPath, const GltfSource& source,
                                        const Scene& scene, const Bake& bake, const BakeRecord& record,
                                        const BakedFileOptions& options) {
    std::vector<std::string> notes;
    std::vector<uint8_t> bytes;
    try {
        bytes = bakedBytes(source, scene, bake, record, options, notes);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw FileError(source.path, error.what());
    }
    if (bytes.size() > options.mostBytes) throw FileTooLarge(outPath, bytes.size());
    replaceFile(outPath, bytes);
    return notes;
}

std::vector<std::string> writeBakedFile(const std::string& outPath, const std::string& sourcePath,
                                        const Scene& scene, const Bake& bake, const BakeRecord& record,
                                        const GltfLoadOptions& loaded) {
    GltfSource source = openGltf(sourcePath);
    loadGltf(source, loaded);
    return writeBakedFile(outPath, source, scene, bake, record);
}

}  // namespace phat
