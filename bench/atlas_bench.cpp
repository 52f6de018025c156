// Unwrapping large meshes.

#include <benchmark/benchmark.h>

#include <cmath>

#include "core/atlas/atlas.h"

namespace phat {
namespace {

// A sphere with hills: 4 * side^2 triangles, closed by position at its seam.
Scene hillySphere(uint32_t side) {
    Scene scene;
    scene.materials.emplace_back();
    const uint32_t columns = 2 * side, rows = side;
    for (uint32_t y = 0; y <= rows; ++y) {
        for (uint32_t x = 0; x <= columns; ++x) {
            const float phi = 2 * kPi * float(x % columns) / float(columns),
                        theta = kPi * float(y) / float(rows);
            const float sine = y == 0 || y == rows ? 0 : std::sin(theta);
            const glm::vec3 d(sine * std::cos(phi), sine * std::sin(phi), -std::cos(theta));
            scene.positions.push_back(
                d * (1 + 0.03f * std::sin(9 * d.x) * std::sin(11 * d.y) * std::sin(7 * d.z)));
            scene.normals.push_back(d);
        }
    }
    for (uint32_t y = 0; y < rows; ++y) {
        for (uint32_t x = 0; x < columns; ++x) {
            const uint32_t i = y * (columns + 1) + x, up = i + columns + 1;
            scene.triangles.push_back({i, i + 1, up + 1});
            scene.triangles.push_back({i, up + 1, up});
        }
    }
    Surface surface;
    surface.triangleCount = uint32_t(scene.triangles.size());
    surface.vertexCount = uint32_t(scene.positions.size());
    scene.surfaces.push_back(surface);
    scene.triangleSurface.assign(scene.triangles.size(), 0);
    return scene;
}

void unwrap(benchmark::State& state) {
    const Scene scene = hillySphere(uint32_t(state.range(0)));
    SilentProgress progress;
    AtlasStats stats;
    for (auto _ : state) benchmark::DoNotOptimize(buildAtlas(scene, {}, AtlasSettings{}, progress, &stats));
    state.counters["triangles"] = double(scene.triangles.size());
    state.counters["charts"] = stats.chartCount;
    state.counters["coverage"] = stats.coverage;
    state.counters["within stretch 1.5"] = stats.areaWithinStretch15;
}
BENCHMARK(unwrap)->Arg(100)->Arg(500)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1);

void texelPoints(benchmark::State& state) {
    const Scene scene = hillySphere(uint32_t(state.range(0)));
    SilentProgress progress;
    const Atlas atlas = buildAtlas(scene, {}, AtlasSettings{}, progress);
    for (auto _ : state) benchmark::DoNotOptimize(buildTexelPoints(scene, atlas));
}
BENCHMARK(texelPoints)->Arg(500)->Unit(benchmark::kSecond)->UseRealTime()->Iterations(1);

}  // namespace
}  // namespace phat
