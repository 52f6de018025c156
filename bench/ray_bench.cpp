// Rays in a shader: one reflection ray for each pixel that shows a surface.

#include "bench_scene.h"
#include "core/base/random.h"
#include "core/bvh/bvh_rays.h"
#include "core/scene/camera_ray.h"
#include "core/scene/shading.h"
#include "gl/bvh_upload.h"
#include "gl/fullscreen.h"
#include "gl/gl_context.h"
#include "gl/textures.h"

namespace phat {
namespace {

constexpr const char* kShaders = PHAT_SOURCE_DIR "/shaders";
constexpr glm::uvec2 kSize(640, 360);

// Of the specular lobe, [y][x]; where there is none its greatest distance is 0.
struct PixelRays {
    std::vector<glm::vec4> origins, directions;
    int count = 0;
};

PixelRays reflectionRays(const Scene& scene) {
    const RayScene rays(scene);
    PixelRays made;
    for (uint32_t i = 0; i < kSize.x * kSize.y; ++i) {
        Rng rng(hashOf(7, i));
        const glm::vec2 pixel(float(i % kSize.x) + 0.5f, float(i / kSize.x) + 0.5f);
        const Ray seen = cameraRay(scene.cameras.front(), int(kSize.x), int(kSize.y), pixel);
        made.origins.emplace_back(0);
        made.directions.emplace_back(0);
        const Hit hit = visibleHit(rays, seen);
        if (!hit) continue;
        const SurfacePoint point = surfaceAt(scene, hit, seen.direction);
        const glm::vec3 towardEye = point.shading.toLocal(-seen.direction);
        const glm::vec3 half = squareToVisibleNormal(rng.uniform2(), towardEye, point.brdf.alpha);
        const glm::vec3 direction = point.shading.toWorld(glm::reflect(-towardEye, half));
        if (!(glm::dot(direction, point.normalGeometric) > 0)) continue;
        made.origins.back() =
            glm::vec4(rays.offsetOrigin(point.position, point.normalGeometric), kFarDistance);
        made.directions.back() = glm::vec4(glm::normalize(direction), 0);
        ++made.count;
    }
    return made;
}

GlTexture rayTexture(const std::vector<glm::vec4>& values) {
    GlTexture texture = createTexture2D(GL_RGBA32F, kSize);
    glTextureSubImage2D(texture.name(), 0, 0, 0, GLsizei(kSize.x), GLsizei(kSize.y), GL_RGBA, GL_FLOAT,
                        values.data());
    return texture;
}

double texelsARay(const BvhRays& twin, const PixelRays& rays) {
    BvhReads reads;
    for (size_t i = 0; i < rays.origins.size(); ++i)
        if (rays.origins[i].w > 0)
            twin.closestHit({glm::vec3(rays.origins[i]), glm::vec3(rays.directions[i])}, kFarDistance,
                            &reads);
    return double(reads.texels()) / rays.count;
}

// One iteration is a pass of one ray a pixel.
void traceRays(benchmark::State& state, const std::string& name) {
    const Scene scene = benchScene(name);
    const HeadlessContext context;
    SceneBvh bvh;
    state.counters["build_ms"] = 1e3 * secondsOf([&] { bvh = buildSceneBvh(scene); });
    const PosedBvh posed = poseBvh(bvh, {});
    GpuBvh gpu = uploadBvh(scene, bvh);
    moveBvh(gpu, posed);
    const PixelRays rays = reflectionRays(scene);
    const GlTexture origins = rayTexture(rays.origins), directions = rayTexture(rays.directions);
    const GlTexture hits = createTexture2D(GL_RGBA32F, kSize);
    const GlFramebuffer target = createFramebuffer({{hits.name()}});
    FullscreenProgram program;
    state.counters["compile_ms"] =
        1e3 * secondsOf([&] {
            program = FullscreenProgram(kShaders, "trace_rays.frag", bvhDefines(bvh));
            bindBvh(gpu, program.program, 0);
            program.program.bind("rayOrigins", kBvhUnits, origins.name());
            program.program.bind("rayDirections", kBvhUnits + 1, directions.name());
            program.draw(target, glm::uvec2(1));  // drivers compile at the first use
            glFinish();
        });
    for (auto _ : state) {
        program.draw(target, kSize);
        glFinish();
    }
    state.counters["rays"] = rays.count;
    state.counters["texels_a_ray"] = texelsARay(BvhRays(scene, bvh, posed), rays);
    state.counters["bytes_a_triangle"] = double(sizeof(BvhNode) * (bvh.nodes.size() + posed.nodes.size()) +
                                                sizeof(BvhTriangle) * bvh.triangles.size()) /
                                         double(bvh.triangles.size());
    state.SetLabel(context.rendererName());
}

void tenTimes(benchmark::internal::Benchmark* measured) {
    measured->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(10);
}
BENCHMARK_CAPTURE(traceRays, tabletop, "tabletop")->Apply(tenTimes);
BENCHMARK_CAPTURE(traceRays, gallery, "gallery")->Apply(tenTimes);

}  // namespace
}  // namespace phat
