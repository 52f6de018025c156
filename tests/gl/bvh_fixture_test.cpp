// tests/data/bvh/rooms.bin: trees, rays and hits for the test of the same shader in a browser
// (web/test/bvh.test.js).

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/bvh/bvh_rays.h"
#include "core/scene/posed_scene.h"
#include "gl/bvh_opacity.h"
#include "support/ray_scenes.h"

namespace phat::test {
namespace {

const std::string kFile = PHAT_SOURCE_DIR "/tests/data/bvh/rooms.bin";
constexpr uint32_t kRays = 1024;

// Nothing that a mathematical library computes, so that every machine makes the same bytes.
Scene fixtureScene() {
    Scene scene;
    addRoom(scene, lambert(0.5f), {2, 2, 2});
    TextureImage image;
    image.width = 6;
    image.height = 5;
    Rng rng(91);
    for (int i = 0; i < 30; ++i) image.texels.push_back({255, 255, 255, uint8_t(rng.bits() & 255)});
    scene.images.push_back(image);
    for (uint32_t node = 1; node <= 4; ++node) {
        Scene soup = triangleSoup(90, 0.3f, node);
        for (glm::vec3& p : soup.positions) p = 0.9f * p + 1.0f;
        for (glm::vec2& uv : soup.uv0) uv = 4.0f * rng.uniform2() - 2.0f;
        Material& material = soup.materials[0];
        material.alphaMode = node == 1 ? AlphaMode::mask : node == 2 ? AlphaMode::blend : AlphaMode::opaque;
        material.baseColorTexture.image = 0;
        material.baseColorTexture.wrapU = Wrap::mirroredRepeat;
        material.baseColorTexture.wrapV = Wrap::clampToEdge;
        material.baseColorTexture.uvTransform = glm::mat3x2(0.75f, 0.25f, -0.25f, 0.5f, 0.3f, 0.1f);
        addNode(scene, soup, node);
    }
    return scene;
}

class Bytes {
  public:
    void add(uint32_t word) { add(&word, 1); }
    void add(float value) { add(std::bit_cast<uint32_t>(value)); }
    template <typename T>
    void add(const T* values, size_t count) {
        const auto* bytes = reinterpret_cast<const char*>(values);
        bytes_.insert(bytes_.end(), bytes, bytes + count * sizeof(T));
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
    }
    const std::vector<char>& all() const { return bytes_; }

  private:
    std::vector<char> bytes_;
};

// Header of 16 words, then nodes, triangles, opacity, alphas, origins, directions, hits as trace_rays.frag
// says.
std::vector<char> fixture() {
    PosedScene posed(fixtureScene());
    const SceneBvh bvh = buildSceneBvh(posed.rest());
    std::vector<glm::mat4> moved(5, glm::mat4(1));
    moved[4] = glm::mat4(0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0.125f, 0, -0.125f, 1);  // turned and mirrored
    const PosedBvh top = poseBvh(bvh, moved);
    posed.setState({moved, {}, {}, 0});
    const OpacityTables opacity = opacityTables(posed.scene(), bvh);
    const BvhRays rays(posed.scene(), bvh, top);

    Bytes bytes;
    for (const size_t word : {bvh.nodes.size() + top.nodes.size(), bvh.triangles.size(),
                              opacity.texels.size(), opacity.alphas.size(), size_t(kRays), size_t(top.root),
                              size_t(bvh.firstTransparent), size_t(opacity.firstMaterial)})
        bytes.add(uint32_t(word));
    for (int axis = 0; axis < 3; ++axis) bytes.add(bvh.grid.stepMeters[axis]);
    for (int i = 0; i < 5; ++i) bytes.add(0u);
    bytes.add(bvh.nodes.data(), bvh.nodes.size());
    bytes.add(top.nodes.data(), top.nodes.size());
    bytes.add(bvh.triangles.data(), bvh.triangles.size());
    bytes.add(opacity.texels.data(), opacity.texels.size());
    bytes.add(opacity.alphas.data(), opacity.alphas.size());
    std::vector<glm::vec4> origins, directions, hits;
    Rng rng(92);
    for (uint32_t i = 0; i < kRays; ++i) {
        const Ray ray{0.95f * randomPoint(rng) + 1.0f, glm::normalize(randomPoint(rng))};
        origins.emplace_back(ray.origin, kFarDistance);
        directions.emplace_back(ray.direction, 0);
        const Hit hit = rays.closestHit(ray);
        const auto at = std::find(bvh.order.begin(), bvh.order.end(), hit.triangle);
        const float number = hit ? float(at - bvh.order.begin() + 1) : 0.0f;
        hits.emplace_back(hit.distance, hit.backFace ? -number : number, hit.barycentric);
    }
    for (const auto* values : {&origins, &directions, &hits}) bytes.add(values->data(), values->size());
    return bytes.all();
}

// PHAT_WRITE_FIXTURES=1 writes the file anew after the format has changed.
TEST(BvhFixture, IsWhatIsMadeNow) {
    const std::vector<char> made = fixture();
    if (std::getenv("PHAT_WRITE_FIXTURES")) {
        std::filesystem::create_directories(std::filesystem::path(kFile).parent_path());
        std::ofstream(kFile, std::ios::binary).write(made.data(), std::streamsize(made.size()));
    }
    std::ifstream stream(kFile, std::ios::binary);
    const std::vector<char> stored((std::istreambuf_iterator<char>(stream)), {});
    EXPECT_TRUE(stored == made) << "write it anew with PHAT_WRITE_FIXTURES=1";
}

}  // namespace
}  // namespace phat::test
