// Light that the GPU makes through many changes, and back.

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numeric>

#include "core/dynamic/incremental_baker.h"
#include "gl/light_turns.h"
#include "gl/light_world.h"
#include "support/moving_room.h"

namespace phat::test {
namespace {

double residentMegabytes() {
    std::ifstream file("/proc/self/statm");
    size_t total = 0, resident = 0;
    file >> total >> resident;
    return double(resident) * double(sysconf(_SC_PAGESIZE)) * 1e-6;
}

// Of few texels, without metals, whose noise is that of single PHATexels, and with one shadow map.
Scene plainRoom() {
    Scene scene = roomWithBox();
    scene.materials[scene.surfaces[2].material] = scene.materials[scene.surfaces[1].material];
    scene.lights = {
        spotLight(glm::vec3(0.6f), {0.7f, 0.6f, 0.6f}, glm::normalize(glm::vec3(-0.3f, -1, -0.2f)), 40, 55)};
    scene.lights[0].node = kLampNode;
    return scene;
}

BakeSettings fewTexels() {
    BakeSettings settings;
    settings.atlas.texelBudget = 3'000;
    settings.photons.count = 5'000;
    settings.pathsPerPhatexel = 1;
    return settings;
}

/// The box and the lamp elsewhere, the lamp dimmed, coloured or switched off, a material edited: each of them
/// more often as it is at first.
SceneState randomChange(const Scene& scene, Rng& rng) {
    SceneState state = stateOf(scene);
    const auto happens = [&] { return rng.uniform() < 0.4f; };
    if (happens())
        state =
            boxMoved(scene, {0.5f * rng.uniform() - 0.2f, 0.1f * rng.uniform(), 0.5f * rng.uniform() - 0.2f},
                     360.0f * rng.uniform());
    if (happens()) {
        state.worldFromRest.resize(kLampNode + 1, glm::mat4(1));
        state.worldFromRest[kLampNode] =
            glm::translate(glm::mat4(1), {0.2f * rng.uniform(), -0.3f * rng.uniform(), 0});
    }
    if (happens()) state.lights[0].intensity *= rng.uniform() < 0.5f ? 0.0f : 2 * rng.uniform();
    if (happens()) state.lights[0].intensity *= glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
    if (happens()) state.materials.back().emission = glm::vec3(8 * rng.uniform());
    if (happens()) {
        Material& edited = state.materials[size_t(rng.uniform() * float(state.materials.size() - 1))];
        edited.baseColor = {rng.uniform(), rng.uniform(), rng.uniform(), 1};
        edited.roughness = rng.uniform();
        edited.metallic = rng.uniform();
    }
    return state;
}

/// The room, its light on the GPU, and the baker that follows the geometry, as in the window.
class GpuRoom {
  public:
    /// `firstNumber`: of its rounds.
    GpuRoom(const Scene& scene, const Bake& baked, uint32_t firstNumber)
        : scene_(scene),
          baked_(baked),
          bvh_(buildSceneBvh(scene)),
          posed_(scene),
          engine_(posed_.snapshot(), baked.atlas, baked.points, baked.phatexture, fewTexels()),
          renderer_(input(), kShaderFolder),
          order_(baked.atlas, baked.points),
          number_(firstNumber) {
        renderer_.beginLight(input());
    }

    void show(const SceneState& state) {
        const ChangedParts changed = posed_.setState(state);
        const SharedSnapshot now = posed_.snapshot();
        engine_.setScene(now);
        if (changed.nodes) {
            renderer_.moveScene(now->scene(), baked_.atlas, engine_.scene().points(), now->worldFromRest());
            moved_ = now;
        }
        renderer_.setMaterials(state.materials);
        renderer_.setLights(now->scene().lights);
        LightUpdate geometry = engine_.drainUpdate();
        while (!renderer_.takeUpdate(geometry, 1)) continue;
        order_.noteChange();
    }
    void follow() {
        takeTurns(renderer_, order_, order_.next(order_.size(), eye_), number_);
        renderer_.filterLight();
    }
    void draw() {
        FrameSettings frame;
        frame.width = frame.height = 16;
        frame.camera = eye_;
        frame.samplesPerPixel = 1;
        renderer_.render(frame);
    }
    void settle() {
        while (!order_.settled()) follow();
    }
    StoredLight light() const { return renderer_.readLight(); }
    /// By the block, how far PHATexels are from what their rays meet now.
    std::vector<float> staleness() {
        const std::vector<BlockTurn> blocks = turnsOf(baked_.atlas, 0);
        return renderer_.traceLight(
            {.blocks = blocks, .number = ++number_, .irradiance = false, .compares = true});
    }

  private:
    RendererInput input() const { return {scene_, baked_.atlas, baked_.points, baked_.phatexture, &bvh_}; }

    const Scene& scene_;
    const Bake& baked_;
    SceneBvh bvh_;
    PosedScene posed_;
    IncrementalBaker engine_;
    SharedSnapshot moved_;  // that the renderer reads
    Renderer renderer_;
    BlockOrder order_;
    Camera eye_ = lookAtCamera({0.5f, 0.7f, 0.95f}, {0.4f, 0.1f, 0.3f}, 60);
    uint32_t number_;
};

/// Of the texels that are on surfaces at rest.
struct Settled {
    std::array<std::vector<double>, 2> irradiance;  // [source], luminance
    int phatexels = 0;
    std::vector<float> staleness;  // [block]
};

// What the bake found has been forgotten after some rounds in darkness.
void darken(GpuRoom& room, const Scene& scene) {
    SceneState dark = stateOf(scene);
    dark.lights[0].intensity = glm::vec3(0);
    dark.materials.back().emission = glm::vec3(0);
    room.show(dark);
    for (int i = 0; i < 4; ++i) room.follow();
}

Settled settleAtRest(GpuRoom& room, const Scene& scene, const Bake& baked) {
    room.show(stateOf(scene));
    room.settle();
    Settled settled;
    const StoredLight light = room.light();
    for (size_t i = 0; i < baked.points.state.size(); ++i) {
        if (baked.points.state[i] != TexelState::surface) continue;
        for (size_t s = 0; s < 2; ++s) {
            settled.irradiance[s].push_back(double(luminance(light.irradiance[s][i])));
            settled.phatexels += unpackPhatexel(light.phatexels[s][i], 1).valid;
        }
    }
    settled.staleness = room.staleness();
    return settled;
}

double sumOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}
double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
    return sum / sumOf(b);
}

void expectSameLight(const Settled& back, const std::array<Settled, 2>& untouched) {
    for (size_t s = 0; s < 2; ++s) {
        const auto& [first, second] = untouched;
        const double noise = distance(second.irradiance[s], first.irradiance[s]);
        const double mean = sumOf(back.irradiance[s]) / sumOf(first.irradiance[s]);
        std::printf("source %zu: mean %.4f, distance %.4f, of two untouched ones %.4f\n", s, mean,
                    distance(back.irradiance[s], first.irradiance[s]), noise);
        // The noise of a thousand texels, neighbours alike, is known to some hundredths.
        EXPECT_LT(distance(back.irradiance[s], first.irradiance[s]), 1.25 * noise) << s;
        EXPECT_NEAR(mean, 1, noise) << s;
    }
    for (const float stale : back.staleness) EXPECT_LT(stale, BlockOrder::kAgrees);
}

// As in the window, changes overtake the light. PHAT_SOAK_MOVES makes so many instead of the suite's.
TEST(GpuLight, AfterAnyChangesAndBackItIsTheUntouchedLightInFlatMemory) {
    const char* wanted = std::getenv("PHAT_SOAK_MOVES");
    const int moves = wanted ? std::atoi(wanted) : 120;
    const Scene scene = plainRoom();
    SilentProgress progress;
    const Bake baked = bake(scene, fewTexels(), progress);
    const HeadlessContext context;
    std::array<Settled, 2> untouched;
    for (uint32_t i = 0; i < 2; ++i) {
        GpuRoom room(scene, baked, 1'000'000 * (i + 1));
        darken(room, scene);
        untouched[i] = settleAtRest(room, scene, baked);
    }
    GpuRoom room(scene, baked, 0);
    Rng rng(3);
    std::vector<double> megabytes;
    for (int i = 0; i < moves; ++i) {
        room.show(randomChange(scene, rng));
        for (float rounds = 2 * rng.uniform(); rounds > 0; --rounds) room.follow();
        if (rng.uniform() < 0.3f) room.draw();
        megabytes.push_back(residentMegabytes());
    }
    // Shadow maps come and go, of 17 MB; at its most it is flat once all is there that is made when it is
    // first used. A texture of the atlas's size, of four words, that a move leaves behind would be 4 MB.
    const auto third = megabytes.begin() + ptrdiff_t(megabytes.size() / 3);
    const double early = *std::max_element(megabytes.begin(), third),
                 late = *std::max_element(third, megabytes.end());
    std::printf("%.1f MB at most in the first third, then %.1f\n", early, late);
    EXPECT_LT(late, early + 2);
    const Settled back = settleAtRest(room, scene, baked);
    expectSameLight(back, untouched);
    // The bake and the GPU cover texels at the border of a contact by chance.
    EXPECT_NEAR(back.phatexels, untouched[0].phatexels, 0.01 * untouched[0].phatexels);
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace phat::test
