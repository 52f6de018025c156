// Photons traced per second, and queries of the photon index per second.

#include <benchmark/benchmark.h>

#include "core/transport/photon_map.h"

namespace phat {
namespace {

// A closed room of 4 x 3 x 5 m with a lamp, every wall a grid of quads, rough plastic.
Scene room(int quadsPerSide) {
    Scene scene;
    Material wall;
    wall.baseColor = {0.6f, 0.6f, 0.6f, 1};
    wall.metallic = 0;
    wall.roughness = 0.5f;
    scene.materials = {wall, wall};
    scene.materials[1].emission = glm::vec3(10);
    scene.surfaces.resize(2);
    scene.surfaces[1].material = 1;
    const glm::vec3 size(4, 3, 5);

    const auto addQuad = [&](uint32_t surface, glm::vec3 corner, glm::vec3 along, glm::vec3 across) {
        const uint32_t first = uint32_t(scene.positions.size());
        const glm::vec3 normal = glm::normalize(glm::cross(along, across));
        for (glm::vec3 p : {corner, corner + along, corner + along + across, corner + across}) {
            scene.positions.push_back(p);
            scene.normals.push_back(normal);
        }
        scene.triangles.push_back({first, first + 1, first + 2});
        scene.triangles.push_back({first, first + 2, first + 3});
        for (int i = 0; i < 2; ++i) scene.triangleSurface.push_back(surface);
        scene.surfaces[surface].triangleCount += 2;
        scene.surfaces[surface].vertexCount += 4;
    };
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far(0);
        along[(axis + 1) % 3] = size[(axis + 1) % 3] / float(quadsPerSide);
        across[(axis + 2) % 3] = size[(axis + 2) % 3] / float(quadsPerSide);
        far[axis] = size[axis];
        for (int i = 0; i < quadsPerSide * quadsPerSide; ++i) {
            const glm::vec3 corner = float(i % quadsPerSide) * along + float(i / quadsPerSide) * across;
            addQuad(0, corner, along, across);
            addQuad(0, corner + far, across, along);
        }
    }
    scene.surfaces[1].firstTriangle = uint32_t(scene.triangles.size());
    scene.surfaces[1].firstVertex = uint32_t(scene.positions.size());
    addQuad(1, {1.5f, 2.9f, 2}, {1, 0, 0}, {0, 0, 1});
    scene.tangents.assign(scene.positions.size(), glm::vec4(0));
    scene.uv0.assign(scene.positions.size(), glm::vec2(0));
    scene.uv1 = scene.uv0;
    scene.colors.assign(scene.positions.size(), glm::vec4(1));
    return scene;
}

PhotonMap traceRoom(const Scene& scene, uint64_t count) {
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    PhotonSettings settings;
    settings.count = count;
    return tracePhotons(rays, lights, settings, progress);
}

void BM_TracePhotons(benchmark::State& state) {
    const Scene scene = room(int(state.range(0)));
    const RayScene rays(scene);
    const LightSampler lights(scene);
    SilentProgress progress;
    PhotonSettings settings;
    settings.count = 100'000;
    uint64_t stored = 0;
    for (auto _ : state) {
        const PhotonMap map = tracePhotons(rays, lights, settings, progress);
        stored += map.stats.stored;
        ++settings.seed;
    }
    state.SetItemsProcessed(int64_t(settings.count) * state.iterations());
    state.counters["stored_per_second"] = benchmark::Counter(double(stored), benchmark::Counter::kIsRate);
    state.counters["triangles"] = double(scene.triangles.size());
}
BENCHMARK(BM_TracePhotons)->Arg(1)->Arg(100)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_BuildPhotonIndex(benchmark::State& state) {
    const Scene scene = room(1);
    const PhotonMap map = traceRoom(scene, uint64_t(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(PhotonIndex(map.photons));
    state.SetItemsProcessed(int64_t(map.photons.size()) * state.iterations());
}
BENCHMARK(BM_BuildPhotonIndex)->Arg(100'000)->Unit(benchmark::kMillisecond);

// Arguments: neighbours, whether by photonIrradiance (normals and a filter) or the bare search.
void BM_NearestPhotons(benchmark::State& state) {
    const Scene scene = room(1);
    const PhotonMap map = traceRoom(scene, 100'000);
    const PhotonIndex index(map.photons);
    const uint32_t k = uint32_t(state.range(0));
    const bool estimate = state.range(1) != 0;
    const auto keep = [](const Photon& photon) { return !photon.firstHit; };
    std::vector<PhotonIndex::Neighbor> found;
    Rng rng(1);
    for (auto _ : state) {
        const Photon& at = map.photons[rng.bits() % map.photons.size()];
        if (estimate) {
            benchmark::DoNotOptimize(
                photonIrradiance({map, index}, at.position, at.normal, {k, 0.25f}, keep));
        } else {
            index.nearest(at.position, k, 0.25f, found);
            benchmark::DoNotOptimize(found.data());
        }
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_NearestPhotons)->ArgsProduct({{1, 50, 200}, {0, 1}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace phat
