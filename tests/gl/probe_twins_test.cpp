// Probes by GLSL against their C++ twin.

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/probes/light_probes.h"
#include "gl/gl_context.h"
#include "gl/gl_evaluate.h"
#include "gl/probe_upload.h"

namespace phat::test {
namespace {

glm::vec3 randomPoint(Rng& random) {
    return {random.uniform2(), random.uniform()};
}

// A grid of 2x1x1 cells, of which the second is divided twice, with light and distances of every kind.
LightProbes randomProbes(bool area) {
    Rng random(1);
    LightProbes probes;
    probes.lowWorld = {-1, 0.5f, 2};
    probes.cellMeters = {0.5f, 1, 0.75f};
    probes.gridSize = {2, 1, 1};
    const auto cell = [&] {
        ProbeCell corners;
        for (uint16_t& corner : corners) corner = uint16_t(random.bits() % 40);
        if (random.bits() % 4 == 0) corners[random.bits() % 8] = kNoProbe;
        return corners;
    };
    probes.cells = {cell(), {kDividedCell, 2, 0}};
    for (int i = 0; i < 16; ++i) probes.cells.push_back(cell());
    probes.cells[5] = {kDividedCell, 10, 0};
    probes.cells[4].fill(kNoProbe);
    for (int i = 0; i < 40; ++i) {
        IrradianceSh sh[2];
        for (IrradianceSh& source : sh)
            for (int light = 0; light < 2; ++light)
                source.addLight(spherePoint(int(random.bits() % 1000), 1000),
                                std::exp2(6 * random.uniform()) * randomPoint(random));
        probes.indirect.push_back(packIrradianceSh(sh[0]));
        if (area) probes.area.push_back(packIrradianceSh(sh[1]));
        std::array<float, kDistanceNodes * kDistanceNodes> reciprocal{};
        const float near = 0.1f + random.uniform();
        for (float& value : reciprocal) value = random.uniform() / near;
        const ProbeDistances distances = packDistances(reciprocal, probes.unitMeters());
        probes.distances.push_back(distances.code);
        probes.places.push_back(
            packPlace(0.1f * (2.0f * randomPoint(random) - 1.0f), distances.rangeCode, probes.unitMeters()));
    }
    return probes;
}

struct ProbeTwins : ::testing::TestWithParam<std::tuple<GlslFlavor, bool>> {
    HeadlessContext context;
};
INSTANTIATE_TEST_SUITE_P(Flavors, ProbeTwins,
                         ::testing::Combine(::testing::Values(GlslFlavor::desktop, GlslFlavor::web),
                                            ::testing::Bool()));

// Exponents of hidden weights magnify the rounding of distances.
TEST_P(ProbeTwins, HaveTheSameIrradiance) {
    const auto [flavor, area] = GetParam();
    const LightProbes probes = randomProbes(area);
    ASSERT_TRUE(isConsistent(probes));
    Rng random(2);
    std::vector<std::array<glm::vec4, 4>> rows(2000);
    for (auto& row : rows) {
        const glm::vec3 u = 1.2f * randomPoint(random) - 0.1f;
        row[0] = glm::vec4(probes.lowWorld + u * probes.cellMeters * glm::vec3(probes.gridSize), 0);
        row[1] = glm::vec4(spherePoint(int(random.bits() % 1000), 1000), 0);
        row[2] = glm::vec4(spherePoint(int(random.bits() % 1000), 1000), 0);
    }
    const GpuProbes gpu = uploadProbes(probes);
    const auto bind = [&](GLuint program) {
        const GLuint textures[] = {gpu.cells.name(), gpu.light.name(), gpu.distances.name()};
        const char* names[] = {"probeCells", "probeLight", "probeDistances"};
        for (int i = 0; i < 3; ++i) {
            glBindTextureUnit(GLuint(3 + i), textures[i]);
            glUniform1i(glGetUniformLocation(program, names[i]), 3 + i);
        }
        const auto vector = [&](const char* name, glm::vec3 v) {
            glUniform3f(glGetUniformLocation(program, name), v.x, v.y, v.z);
        };
        vector("probeLow", gpu.lowWorld);
        vector("probeCellMeters", gpu.cellMeters);
        vector("probeGrid", gpu.gridSize);
        glUniform1i(glGetUniformLocation(program, "probeTexels"), gpu.texelsPerProbe);
    };
    const std::string look =
        "vec3 normals[2] = vec3[2](b.xyz, c.xyz); ProbeIrradiance e = probeIrradiance(a.xyz, normals);";
    const auto run = [&](const std::string& value) {
        return evaluateGlsl("lib/probe_light.glsl", look + "result = vec4(" + value + ", 0.0);", rows, flavor,
                            0, 0, bind);
    };
    const auto indirect = run("e.indirect[0]"), mirrored = run("e.indirect[1]"), direct = run("e.area[0]");
    int dark = 0;
    for (size_t i = 0; i < rows.size(); ++i) {
        const ProbeIrradiance e = probeIrradianceAt(probes, rows[i][0], rows[i][1]);
        const ProbeIrradiance m = probeIrradianceAt(probes, rows[i][0], rows[i][2]);
        dark += e.indirect == glm::vec3(0);
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(indirect[i][c], e.indirect[c], 1e-3f * e.indirect[c] + 1e-4f) << "row " << i;
            ASSERT_NEAR(mirrored[i][c], m.indirect[c], 1e-3f * m.indirect[c] + 1e-4f) << "row " << i;
            ASSERT_NEAR(direct[i][c], e.area[c], 1e-3f * e.area[c] + 1e-4f) << "row " << i;
        }
    }
    EXPECT_GT(dark, 20);
    EXPECT_LT(dark, 500);
}

}  // namespace
}  // namespace phat::test
