#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/atlas/texel_point_bytes.h"
#include "core/bvh/restore_bvh.h"
#include "io/base/file_error.h"
#include "io/gltf/gltf_rewrite.h"
#include "io/phat/bake_record.h"
#include "io/phat/baked_file.h"
#include "io/phat/baked_layout.h"
#include "io/phat/payload_reader.h"
#include "io/phat/phatexture_read.h"
#include "io/phat/probes_payload.h"
#include "io/phat/scene_lighting.h"

namespace phat {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& reason) {
    throw std::runtime_error(reason);
}

glm::uvec2 readSize(const json& object, uint64_t maxSide) {
    const auto size = object.at("size").get<std::array<double, 2>>();
    for (const double side : size)
        if (!(side >= 1 && side <= double(maxSide)) || side != std::floor(side))
            fail(fmt::format("a size of {} x {} is not possible", size[0], size[1]));
    return {uint32_t(size[0]), uint32_t(size[1])};
}

void checkChart(const Atlas& atlas, const Chart& chart, size_t surfaceCount) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    for (int axis = 0; axis < 2; ++axis)
        if (chart.originTile[axis] >= tiles[axis] || chart.sizeTiles[axis] == 0 ||
            chart.sizeTiles[axis] > tiles[axis] - chart.originTile[axis])
            fail("a chart lies outside the atlas");
    if (chart.surface >= surfaceCount) fail("a chart belongs to no surface");
    if (!(chart.texelSizeMeters > 0 && chart.texelSizeMeters <= atlas.texelSizeMeters))
        fail("a chart's texel size is not positive, or larger than the atlas's");
    if (chart.otherSide == kNoChart) return;
    if (chart.otherSide >= atlas.charts.size() ||
        atlas.charts[chart.otherSide].sizeTiles != chart.sizeTiles ||
        atlas.charts[chart.otherSide].texelSizeMeters != chart.texelSizeMeters)
        fail("a chart's other side does not fit it");
}

void readCharts(PayloadReader& reader, const json& object, size_t surfaceCount, Atlas& atlas) {
    const glm::uvec2 tiles = atlas.sizeTiles();
    const uint64_t tileCount = uint64_t(tiles.x) * tiles.y;
    const uint64_t chartCount = wholeNumber(object, "chartCount");
    if (chartCount > tileCount) fail("there are more charts than tiles");
    for (const ChartRecord& r : readPayload<ChartRecord>(reader, object, "charts", chartCount)) {
        Chart chart;
        chart.originTile = {r.originTileX, r.originTileY};
        chart.sizeTiles = {r.sizeTilesX, r.sizeTilesY};
        chart.surface = r.surface;
        chart.back = r.back != 0;
        chart.otherSide = r.otherSide;
        chart.texelSizeMeters = r.texelSizeMeters;
        atlas.charts.push_back(chart);
    }
    uint64_t blocks = 0, chartTiles = 0;
    for (const Chart& chart : atlas.charts) {
        checkChart(atlas, chart, surfaceCount);
        blocks += uint64_t(chart.blocksWide()) * chart.blocksHigh();
        chartTiles += uint64_t(chart.sizeTiles.x) * chart.sizeTiles.y;
    }
    if (blocks > std::numeric_limits<uint32_t>::max()) fail("there are too many blocks");
    if (chartTiles > tileCount) fail("charts overlap");
    numberBlocks(atlas);

    atlas.tileChart = readPayload<uint32_t>(reader, object, "tiles", tileCount);
    for (uint64_t i = 0; i < tileCount; ++i) {
        const uint32_t index = atlas.tileChart[i];
        if (index == kNoChart) continue;
        if (index >= chartCount) fail("a tile belongs to a chart that does not exist");
        const Chart& chart = atlas.charts[index];
        const glm::uvec2 within =
            glm::uvec2(i % tiles.x, i / tiles.x) - chart.originTile;  // wraps if outside
        if (within.x >= chart.sizeTiles.x || within.y >= chart.sizeTiles.y)
            fail("a tile lies outside its chart");
    }
}

// Whoever crafts a file computes the checksum; a fuzzer does not guess it.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr bool kChecksTexels = false;
#else
constexpr bool kChecksTexels = true;
#endif

// Texel coordinates as they were baked, from the UV set and what rounding took away.
void readTriangleTexels(PayloadReader& reader, const json& object, uint64_t texCoord, const Scene& scene,
                        Atlas& atlas) {
    const size_t triangleCount = scene.triangles.size();
    atlas.triangleTexels.resize(triangleCount);
    const std::string name = fmt::format("TEXCOORD_{}", texCoord);
    for (const Surface& surface : scene.surfaces) {
        const SurfaceCorners corners = surfaceCorners(reader.source, scene, surface);
        const json& attributes = gltfItem(reader.source.json, "meshes", surface.mesh)
                                     .at("primitives")
                                     .at(surface.primitive)
                                     .at("attributes");
        const AccessorElements uvs =
            readAccessor(reader.source, wholeNumber(attributes, name.c_str()), corners.vertexCount);
        constexpr uint32_t kFloat = 5126;
        if (uvs.componentType != kFloat || uvs.elementSize != sizeof(glm::vec2))
            fail(fmt::format("{} of \"{}\" is not the atlas's", name, surface.name));
        for (uint32_t t = 0; t < surface.triangleCount; ++t)
            for (int corner = 0; corner < 3; ++corner) {
                glm::vec2 uv;
                std::memcpy(&uv, &uvs.bytes[size_t(corners.vertices[t][corner]) * sizeof(uv)], sizeof(uv));
                if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1))
                    fail(fmt::format("\"{}\" leaves the atlas", surface.name));
                atlas.triangleTexels[surface.firstTriangle + t][corner] = texelFromUv(uv, atlas.sizeTexels);
            }
    }
    if (object.contains("texelCorrection")) {
        const auto correction = readPayload<int8_t>(reader, object, "texelCorrection", triangleCount * 6);
        for (size_t i = 0; i < correction.size(); ++i) {
            float& value = atlas.triangleTexels[i / 6][i / 2 % 3][int(i % 2)];
            // Zero has no neighbour below; the writer corrects by steps that stay positive.
            if (correction[i] != 0) value = std::max(0.0f, movedByUlps(value, correction[i]));
        }
    }
    const auto bytes = bytesOf(atlas.triangleTexels);
    const uint64_t checksum = wholeNumber(object, "texelChecksum");
    if (kChecksTexels && checksum != crc32_z(crc32_z(0, nullptr, 0), bytes.data(), bytes.size()))
        fail("the atlas UVs are not those that were baked: another program has changed the geometry");
}

// Of an atlas by its triangles. Charts are injective but for rounding, those of `--use-uv` likewise.
constexpr double kMaxCoverings = 1.5;

void readTriangleCharts(PayloadReader& reader, const json& object, const Scene& scene, Atlas& atlas) {
    double covered = 0;  // texels
    atlas.triangleChart = readPayload<uint32_t>(reader, object, "triangles", scene.triangles.size());
    for (size_t t = 0; t < atlas.triangleChart.size(); ++t) {
        const uint32_t index = atlas.triangleChart[t];
        if (index == kNoChart) continue;
        if (index >= atlas.charts.size()) fail("a triangle belongs to a chart that does not exist");
        if (scene.surfaces[atlas.charts[index].surface].node != scene.surfaces[scene.triangleSurface[t]].node)
            fail("a triangle and its chart belong to different nodes");
        const glm::vec2 low(atlas.charts[index].originTexel());
        const glm::vec2 high = low + glm::vec2(atlas.charts[index].sizeTexels());
        const auto& corners = atlas.triangleTexels[t];
        for (const glm::vec2& texel : corners)
            if (!(texel.x >= low.x && texel.y >= low.y && texel.x <= high.x && texel.y <= high.y))
                fail("a triangle lies outside its chart");
        const glm::dvec2 along = corners[1] - corners[0], across = corners[2] - corners[0];
        covered += 0.5 * std::abs(along.x * across.y - along.y * across.x);
    }
    // Each is rasterised in full, which takes its time: the map from the surface to texels is one-to-one.
    if (covered > kMaxCoverings * double(atlas.texelCount())) fail("triangles overlap in the atlas");
}

Atlas readAtlas(PayloadReader& reader, const json& extension, const Scene& scene) {
    const json& object = extension.at("atlas");
    Atlas atlas;
    atlas.sizeTexels = readSize(object, kMaxAtlasSide);
    if (atlas.sizeTexels % kTileSize != glm::uvec2(0)) fail("the atlas does not consist of whole tiles");
    reader.budget.charge(kTexelPointBytes * atlas.texelCount(), "its atlas");
    atlas.texelSizeMeters = object.at("texelSize").get<float>();
    if (!(atlas.texelSizeMeters > 0 && std::isfinite(atlas.texelSizeMeters)))
        fail("the texel size is not positive");
    // Older files have none: their distances are in metres.
    atlas.unitMeters = extension.value("lengthUnit", 1.0f);
    if (!(atlas.unitMeters > 0 && std::isfinite(atlas.unitMeters)))
        fail("the unit of length is not positive");
    readCharts(reader, object, scene.surfaces.size(), atlas);
    atlas.triangleSurface = scene.triangleSurface;
    readTriangleTexels(reader, object, wholeNumber(extension, "texCoord"), scene, atlas);
    readTriangleCharts(reader, object, scene, atlas);
    return atlas;
}

TexelPoints readTexelPoints(PayloadReader& reader, const json& object, const Scene& scene,
                            const Atlas& atlas) {
    const auto occluded = readPayload<uint8_t>(reader, object, "covered", (atlas.texelCount() + 7) / 8);
    TexelPoints points = buildTexelPoints(scene, atlas);
    for (size_t i = 0; i < atlas.texelCount(); ++i) {
        const glm::uvec2 texel(i % atlas.sizeTexels.x, i / atlas.sizeTexels.x);
        if (points.state[i] != TexelState::unused && atlas.chartAt(texel) == kNoChart)
            fail("a surface lies on a tile that has no chart");
        if (!(occluded[i / 8] >> i % 8 & 1)) continue;
        if (points.state[i] == TexelState::unused) fail("a texel without a surface is marked as occluded");
        points.state[i] = TexelState::occluded;
    }
    return points;
}

Environment readEnvironment(PayloadReader& reader, const json& object) {
    const glm::uvec2 size = readSize(object, kMaxEnvironmentSide);
    const float scale = object.at("scale").get<float>();
    if (!(scale > 0 && std::isfinite(scale))) fail("the environment's scale is not positive");
    const auto packed = readPayload<uint32_t>(reader, object, "radiance", uint64_t(size.x) * size.y);
    Environment environment{Image(int(size.x), int(size.y))};
    for (size_t i = 0; i < packed.size(); ++i)
        environment.radiance.pixels[i] = scale * unpackRgb9e5(packed[i]);
    return environment;
}

// Geometry or materials may have been changed since, by other programs too: then there are none.
std::optional<SceneBvh> readBvh(PayloadReader& reader, const json& extension, const Scene& scene) {
    if (!extension.contains("bvh")) return std::nullopt;
    const json& object = extension["bvh"];
    const uint64_t nodeCount = wholeNumber(object, "nodeCount");
    // A node has two children or more, or is a group's root.
    if (nodeCount > scene.triangles.size() + kMaxBvhGroups)
        fail("there are more nodes than triangles for them");
    auto nodes = readPayload<BvhNode>(reader, object, "nodes", nodeCount);
    return restoreSceneBvh(scene, std::move(nodes),
                           readPayload<uint32_t>(reader, object, "order", scene.triangles.size()));
}

BakeRecord readRecord(const json& extension, PhatexelStorage storage) {
    const json record = extension.value("record", json::object());
    return {record.value("generator", ""), record.value("input", ""), record.value("settings", ""),
            wholeNumber(record, "seed", 1), storage};
}

// The charts and triangles of the bake count surfaces in the order of the original file. A mesh of its own
// for every node changes the order in which the loader meets them.
void restoreSurfaceOrder(const json& extension, Scene& scene) {
    const json& order = extension.at("surfaces");
    if (order.size() != scene.surfaces.size()) fail("the surfaces are not those that were baked");
    std::map<std::pair<uint64_t, uint64_t>, size_t> loaded;
    for (size_t i = 0; i < scene.surfaces.size(); ++i)
        loaded[{scene.surfaces[i].node, scene.surfaces[i].primitive}] = i;

    std::vector<Surface> surfaces;
    std::vector<glm::uvec3> triangles;
    std::vector<uint32_t> triangleSurface;
    for (const json& item : order) {
        const auto found = loaded.extract({wholeNumber(item, "node"), wholeNumber(item, "primitive")});
        if (!found) fail("the surfaces are not those that were baked");
        Surface surface = scene.surfaces[found.mapped()];
        const auto first = scene.triangles.begin() + surface.firstTriangle;
        surface.firstTriangle = uint32_t(triangles.size());
        triangles.insert(triangles.end(), first, first + surface.triangleCount);
        triangleSurface.insert(triangleSurface.end(), surface.triangleCount, uint32_t(surfaces.size()));
        surfaces.push_back(std::move(surface));
    }
    scene.surfaces = std::move(surfaces);
    scene.triangles = std::move(triangles);
    scene.triangleSurface = std::move(triangleSurface);
}

const json* findExtension(const json& gltf) {
    const auto extensions = gltf.find("extensions");
    if (extensions == gltf.end() || !extensions->is_object()) return nullptr;
    const auto found = extensions->find(kPhatExtension);
    return found == extensions->end() ? nullptr : &*found;
}

// Also where the version is checked: it says whether there is a choice.
PhatexelStorage storageOf(const json& extension) {
    const uint64_t version = wholeNumber(extension, "version");
    if (version < kBakedFormatVersion || version > kSharedChartsFormatVersion)
        fail(fmt::format("has format version {}; this program reads versions {} to {}: {}", version,
                         kBakedFormatVersion, kSharedChartsFormatVersion,
                         version < kBakedFormatVersion ? "bake the scene again" : "it needs a newer one"));
    const bool mayBePacked = version != kStorageFormatVersion;
    if (version == kBakedFormatVersion || (mayBePacked && !extension.contains("storage")))
        return PhatexelStorage::packed;
    const auto name = extension.at("storage").get<std::string>();
    const auto found = storageNames().find(name);
    if (found == storageNames().end()) fail(fmt::format("has PHATexels in an unknown storage, \"{}\"", name));
    return found->second;
}

const json& extensionOf(const GltfSource& source) {
    const json* extension = findExtension(source.json);
    if (!extension) fail("is not a baked file");
    return *extension;
}

void readExtension(const GltfSource& source, BakedScene& baked) {
    const json& extension = extensionOf(source);
    const PhatexelStorage storage = storageOf(extension);
    PayloadReader reader{source, gltf::MemoryBudget(0)};
    for (const auto& buffer : source.buffers) reader.budget.allowFor(buffer.size());

    Scene& scene = baked.loaded.scene;
    baked.record = readRecord(extension, storage);
    baked.inputs = readInputs(extension.value("inputs", json()));
    restoreAddedLights(source.json, scene);
    restoreSurfaceOrder(extension, scene);
    baked.atlas = readAtlas(reader, extension, scene);
    baked.points = readTexelPoints(reader, extension.at("atlas"), scene, baked.atlas);
    baked.phatexture = readPhatexture(reader, extension, storage, baked.atlas);
    baked.bvh = readBvh(reader, extension, scene);
    baked.probes = readLightProbes(reader, extension);
    if (extension.contains("environment"))
        scene.environment = readEnvironment(reader, extension["environment"]);
}

}  // namespace

bool isBakedFile(const GltfSource& source) {
    return findExtension(source.json) != nullptr;
}

bool isBakedFile(const std::string& path) {
    return isBakedFile(openGltf(path));
}

BakedScene readBakedFile(const std::string& path) {
    GltfSource source = openGltf(path);
    return readBakedFile(source);
}

BakedScene readBakedFile(GltfSource& source) {
    BakedScene baked;
    baked.loaded = loadGltf(source);
    try {
        readExtension(source, baked);
    } catch (const std::bad_alloc&) {
        throw FileError(source.path, "needs more memory than there is");
    } catch (const json::exception& error) {
        throw FileError(source.path,
                        fmt::format("its extension {} is malformed ({})", kPhatExtension, error.what()));
    } catch (const std::runtime_error& error) {
        throw FileError(source.path, error.what());
    }
    return baked;
}

PhatexelStorage phatexelStorage(const GltfSource& source) {
    try {
        return storageOf(extensionOf(source));
    } catch (const std::exception& error) {
        throw FileError(source.path, error.what());
    }
}

}  // namespace phat
