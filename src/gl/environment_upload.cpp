#include "gl/environment_upload.h"

#include <bit>
#include <cmath>

#include "core/base/math.h"
#include "core/render/traced_reflections.h"
#include "gl/alias_table.h"
#include "gl/textures.h"

namespace phat {
namespace {

// Of a larger picture, texels are chosen together.
constexpr size_t kMaxCells = 1 << 19;

int cellsAlong(int texels, int cellTexels) {
    return (texels + cellTexels - 1) / cellTexels;
}

// Luminance of the bilinear radiance, whose mean over a texel takes an eighth from either neighbour along an
// axis. [y][x]
std::vector<double> lightOfTexels(const Image& image) {
    const int width = image.width, height = image.height;
    std::vector<double> along(image.pixels.size()), light(image.pixels.size());
    const auto at = [&](int x, int y) { return size_t(y) * size_t(width) + size_t(x); };
    const auto mean = [](double before, double own, double after) {
        return 0.75 * own + 0.125 * (before + after);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            along[at(x, y)] =
                mean(double(luminance(image.at((x + width - 1) % width, y))),
                     double(luminance(image.at(x, y))), double(luminance(image.at((x + 1) % width, y))));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            light[at(x, y)] = mean(along[at(x, std::max(y - 1, 0))], along[at(x, y)],
                                   along[at(x, std::min(y + 1, height - 1))]);
    return light;
}

// Of rows of the picture, between the planes of their borders on the unit sphere.
double heightOf(const Image& image, int firstRow, int pastRow) {
    const auto cosine = [&](int y) { return std::cos(double(kPi) * y / image.height); };
    return cosine(firstRow) - cosine(pastRow);
}

// What of it is sampled, times a number that is as the texel's solid angle. [y][x]
std::vector<double> sampledLight(const Image& image) {
    std::vector<double> light = lightOfTexels(image);
    const auto heightAt = [&](size_t texel) {
        const int row = int(texel / size_t(image.width));
        return heightOf(image, row, row + 1);
    };
    double mean = 0;
    for (size_t i = 0; i < light.size(); ++i) mean += light[i] * heightAt(i) / (2.0 * image.width);
    for (size_t i = 0; i < light.size(); ++i)
        light[i] = std::max(light[i] - double(kMinOverMean) * mean, 0.0) * heightAt(i);
    return light;
}

/// The chances of cells, and the picture with the densities that they lead to.
struct EnvironmentChances {
    glm::ivec2 cells{0};
    std::vector<double> rows;             // sum 1; empty where nothing is sampled
    std::vector<std::vector<double>> of;  // [row]: of its cells, sum 1
    std::vector<glm::vec4> texels;
};

EnvironmentChances chancesOf(const Image& image, int cellTexels) {
    EnvironmentChances found;
    found.cells = {cellsAlong(image.width, cellTexels), cellsAlong(image.height, cellTexels)};
    found.of.assign(size_t(found.cells.y), std::vector<double>(size_t(found.cells.x), 0.0));
    found.rows.assign(size_t(found.cells.y), 0.0);
    const std::vector<double> light = sampledLight(image);
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            found.of[size_t(y / cellTexels)][size_t(x / cellTexels)] +=
                light[size_t(y) * size_t(image.width) + size_t(x)];
    for (size_t row = 0; row < found.rows.size(); ++row) {
        for (const double cell : found.of[row]) found.rows[row] += cell;
        sum += found.rows[row];
    }
    found.texels.reserve(image.pixels.size());
    for (int y = 0; y < image.height; ++y) {
        const int low = y / cellTexels * cellTexels, high = std::min(low + cellTexels, image.height);
        const double heights = heightOf(image, low, high);
        for (int x = 0; x < image.width; ++x) {
            const int left = x / cellTexels * cellTexels, right = std::min(left + cellTexels, image.width);
            const double solidAngle = heights * 2.0 * double(kPi) * (right - left) / image.width;
            const double chance =
                sum > 0 ? found.of[size_t(y / cellTexels)][size_t(x / cellTexels)] / sum : 0.0;
            found.texels.push_back({image.at(x, y), float(std::sqrt(chance / solidAngle))});
        }
    }
    if (!(sum > 0)) found.rows.clear();
    for (size_t row = 0; row < found.rows.size(); ++row) {
        for (double& cell : found.of[row])
            cell = found.rows[row] > 0 ? cell / found.rows[row] : 1.0 / found.cells.x;
        found.rows[row] /= sum;
    }
    return found;
}

void addEntries(std::vector<glm::uvec2>& entries, const std::vector<double>& chances) {
    const AliasTable table = aliasTable(chances);
    for (size_t i = 0; i < chances.size(); ++i)
        entries.emplace_back(std::bit_cast<uint32_t>(table.threshold[i]), table.alias[i]);
}

// Mean of the bilinear radiance over a cell.
glm::vec3 meanRadiance(const Image& image, glm::ivec2 low, glm::ivec2 high) {
    constexpr double kWeights[3] = {0.125, 0.75, 0.125};
    glm::dvec3 sum(0);
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
            for (int i = 0; i < 9; ++i) {
                const int column = (x + i % 3 - 1 + image.width) % image.width;
                const int row = std::clamp(y + i / 3 - 1, 0, image.height - 1);
                sum += kWeights[i % 3] * kWeights[i / 3] * glm::dvec3(image.at(column, row));
            }
    return glm::vec3(sum / double((high.x - low.x) * (high.y - low.y)));
}

// The middles of cells that are chosen systematically.
void addSkyPoints(GpuEnvironment& gpu, const EnvironmentChances& chances, const Image& image) {
    double sum = 0;
    for (int y = 0; y < gpu.cells.y; ++y)
        for (int x = 0; x < gpu.cells.x; ++x) {
            sum += chances.rows[size_t(y)] * chances.of[size_t(y)][size_t(x)];
            const glm::ivec2 low = gpu.cellTexels * glm::ivec2(x, y);
            const glm::ivec2 high = glm::min(low + gpu.cellTexels, glm::ivec2(image.width, image.height));
            const double azimuth = double(kPi) * ((low.x + high.x) / double(image.width) - 1);
            const double polar = double(kPi) * (low.y + high.y) / (2.0 * image.height);
            const float root = chances.texels[size_t(low.y) * size_t(image.width) + size_t(low.x)].a;
            while (int(gpu.points.size()) < kSkyPoints &&
                   double(gpu.points.size()) + 0.5 <= sum * kSkyPoints) {
                gpu.points.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                        std::sin(polar) * std::sin(azimuth), square(root));
                gpu.pointRadiance.emplace_back(meanRadiance(image, low, high), 0);
            }
        }
}

}  // namespace

GpuEnvironment uploadEnvironment(const Environment& environment) {
    const Image& image = environment.radiance;
    GpuEnvironment gpu;
    while (size_t(cellsAlong(image.width, gpu.cellTexels)) *
               size_t(cellsAlong(image.height, gpu.cellTexels)) >
           kMaxCells)
        gpu.cellTexels *= 2;
    const EnvironmentChances chances = chancesOf(image, gpu.cellTexels);
    gpu.cells = chances.cells;
    gpu.picture = createTexture2D(GL_RGBA32F, glm::uvec2(image.width, image.height));
    glTextureSubImage2D(gpu.picture.name(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_FLOAT,
                        chances.texels.data());
    gpu.sampler = createSampler(GL_REPEAT, GL_CLAMP_TO_EDGE, GL_LINEAR, GL_LINEAR);
    if (chances.rows.empty()) return gpu;
    addSkyPoints(gpu, chances, image);
    std::vector<glm::uvec2> entries;
    addEntries(entries, chances.rows);
    for (const std::vector<double>& row : chances.of) addEntries(entries, row);
    std::vector<glm::uvec4> pairs((entries.size() + 1) / 2);
    for (size_t i = 0; i < entries.size(); ++i) {
        pairs[i / 2][i % 2 * 2] = entries[i].x;
        pairs[i / 2][i % 2 * 2 + 1] = entries[i].y;
    }
    gpu.choices = createTable(std::span<const glm::uvec4>(pairs));
    return gpu;
}

void bindEnvironment(const GpuEnvironment& gpu, const ShaderProgram& program, int unit) {
    program.bind("environment", unit, gpu.picture.name(), gpu.picture ? gpu.sampler.name() : 0);
}

void setSkyPoints(const GpuEnvironment& gpu, const ShaderProgram& program, float turn) {
    const float cosine = std::cos(2 * kPi * turn), sine = std::sin(2 * kPi * turn);
    std::vector<glm::vec4> points;
    for (const glm::vec4& p : gpu.points)
        points.emplace_back(cosine * p.x - sine * p.z, p.y, sine * p.x + cosine * p.z, p.w);
    if (points.empty()) return;
    program.set("skyPoints", std::span<const glm::vec4>(points));
    program.set("skyPointRadiance", std::span<const glm::vec4>(gpu.pointRadiance));
}

void bindEnvironmentSamples(const GpuEnvironment& gpu, const ShaderProgram& program, int firstUnit) {
    bindEnvironment(gpu, program, firstUnit);
    program.bind("environmentChoices", firstUnit + 1, gpu.choices.name());
    program.set("environmentCells", gpu.cells);
    program.set("environmentCellTexels", gpu.cellTexels);
}

}  // namespace phat
