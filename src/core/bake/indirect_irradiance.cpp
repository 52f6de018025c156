// Diffuse indirect light by rays that end in the irradiance of the texels themselves.

#include "core/bake/indirect_irradiance.h"

#include "core/bake/gather_parts.h"
#include "core/bake/irradiance_ray.h"

namespace phat {
namespace {

// Rays of a node of the finer levels, which lie closer.
constexpr uint32_t kFineRays = 32;
// Between nodes s texels apart the irradiance is a plane to within some (s / distance)^2 / 8: 1 %, with as
// much again by the smoothing, where the harmonic mean distance of the hits is this many steps.
constexpr float kSplitBelowSteps = 6.0f;
// Bounces of a closed room of albedo .8 converge to a thousandth in thirty; the setting is mostly lower.
constexpr float kConverged = 1e-4f;
// Nodes that a bounce takes in the time of a ray.
constexpr uint64_t kNodesARay = 3;

/// Sums over the rays of a node, once irradiance is known everywhere.
struct NodeSum {
    glm::vec3 irradiance{0};
    float nearness = 0;
};

// Point `index` of the R2 sequence (Roberts 2018) in 32-bit fixed point, which is exact for any index. Every
// run of the sequence is stratified; consecutive nodes in Morton order take consecutive runs, so that
// neighbours complement each other.
glm::vec2 r2Point(uint64_t index, uint64_t shift) {
    const uint32_t x = uint32_t(index) * 3242174889u + uint32_t(shift);
    const uint32_t y = uint32_t(index) * 2447445414u + uint32_t(shift >> 32);
    return glm::vec2(float(x >> 8), float(y >> 8)) * 0x1p-24f;
}

struct Gatherer {
    const GatherInput& input;
    const std::vector<uint32_t>& areaIrradiance;
    const BakeSettings& settings;

    /// Calls visit(IrradianceRay) for a node's rays above the surface: a mean of radiance, also where the
    /// normal of a coarse mesh leans over its triangle. Returns their number.
    template <typename Visit>
    uint32_t trace(const IrradianceLevel& level, size_t node, uint32_t rayCount, uint64_t& rays,
                   const Visit& visit) const {
        const uint32_t texel = level.texel[node];
        const TexelPoints& points = input.points;
        const uint64_t stream = hashOf(settings.seed + 0x1dd, level.step);
        Rng rng(hashOf(stream, texel));
        const glm::uvec2 group =
            glm::uvec2(texel % input.atlas.sizeTexels.x, texel / input.atlas.sizeTexels.x) / level.step;
        const Frame frame = frameFromNormalAndTangent(points.normal[texel], points.tangent[texel]);
        const glm::vec3 flatNormal = flatNormalOf(input.rays.scene(), input.atlas, points, texel);
        const glm::vec3 origin = input.rays.offsetOrigin(points.position[texel], flatNormal);
        uint32_t count = 0;
        for (uint32_t i = 0; i < rayCount; ++i) {
            const glm::vec2 square = r2Point(uint64_t(morton(group.x, group.y)) * rayCount + i, stream);
            const glm::vec3 direction = glm::normalize(frame.toWorld(squareToCosineHemisphere(square)));
            if (glm::dot(direction, flatNormal) <= 0.0f) continue;
            visit(count++,
                  traceToTexels(input, areaIrradiance, {origin, direction}, settings.maxBounces, rng, rays));
        }
        return count;
    }

    NodeRays keepRays(const IrradianceLevel& level, size_t node, uint64_t& rays) const {
        NodeRays kept;
        kept.texel.fill(kNoTexel);
        kept.weight.fill(0);
        glm::vec3 weights(0), rounded(0);
        kept.count = trace(level, node, kNodeRays, rays, [&](uint32_t i, const IrradianceRay& ray) {
            kept.light += ray.light;
            kept.nearness += 1.0f / ray.distance;
            kept.texel[i] = ray.texel;
            kept.weight[i] = packRgb9e5(ray.weight);
            weights += ray.weight;
            rounded += unpackRgb9e5(kept.weight[i]);
        });
        for (int c = 0; c < 3; ++c)
            if (rounded[c] > 0.0f) kept.unrounded[c] = weights[c] / rounded[c];
        kept.nearness /= float(std::max(kept.count, 1u));
        return kept;
    }

    NodeSum sumRays(const IrradianceLevel& level, size_t node, const IrradianceMap& map,
                    uint64_t& rays) const {
        NodeSum sum;
        const uint32_t count = trace(level, node, kFineRays, rays, [&](uint32_t, const IrradianceRay& ray) {
            sum.irradiance += ray.light;
            if (ray.texel != kNoTexel) sum.irradiance += ray.weight * map[ray.texel];
            sum.nearness += 1.0f / ray.distance;
        });
        sum.irradiance *= kPi / float(std::max(count, 1u));
        sum.nearness /= float(std::max(count, 1u));
        return sum;
    }
};

template <typename IrradianceOf>
glm::vec3 bounced(const NodeRays& node, const IrradianceOf& irradianceOf) {
    glm::vec3 linked(0);
    for (uint32_t i = 0; i < node.count; ++i)
        if (node.texel[i] != kNoTexel) linked += unpackRgb9e5(node.weight[i]) * irradianceOf(node.texel[i]);
    return (node.light + node.unrounded * linked) * (kPi / float(std::max(node.count, 1u)));
}

/// Irradiance at the nodes when the texels have that which `irradianceOf` says.
template <typename IrradianceOf>
std::vector<glm::vec3> bounce(const std::vector<NodeRays>& nodes, Progress& progress,
                              const IrradianceOf& irradianceOf) {
    std::vector<glm::vec3> next(nodes.size());
    SilentProgress silent;
    parallelRanges(nodes.size(), 1024, silent, [&](size_t begin, size_t end) {
        progress.throwIfStopped();
        for (size_t n = begin; n < end; ++n) next[n] = bounced(nodes[n], irradianceOf);
    });
    return next;
}

/// [y][x] The node of each texel's group and piece.
std::vector<uint32_t> nodesOfTexels(const IrradianceLevel& level, const GatherInput& input) {
    std::vector<uint32_t> nodes(input.atlas.texelCount());
    SilentProgress silent;
    parallelRanges(nodes.size(), 4096, silent, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel)
            nodes[texel] = level.nodeOf(input.atlas, input.points, uint32_t(texel));
    });
    return nodes;
}

/// Light bounces between the nodes of the coarsest level, each hit taking that of the node of its group and
/// piece, until nothing changes or all bounces are used up.
ResumableTask solve(IrradianceLevel& level, const std::vector<NodeRays>& nodes, const GatherInput& input,
                    int bounces, Progress& progress) {
    level.value.assign(nodes.size(), glm::vec3(0));
    const std::vector<uint32_t> nodeOf = nodesOfTexels(level, input);
    for (int i = 0; i < bounces; ++i) {
        std::vector<glm::vec3> next = bounce(nodes, progress, [&](uint32_t texel) {
            const uint32_t node = nodeOf[texel];
            return node != kNoNode ? level.value[node] : glm::vec3(0);
        });
        float change = 0, largest = 0;
        for (size_t n = 0; n < next.size(); ++n) {
            change = std::max(change, maxComponent(next[n] - level.value[n]));
            largest = std::max(largest, maxComponent(next[n]));
        }
        level.value = std::move(next);
        co_yield nodes.size() / kNodesARay;
        if (change <= kConverged * largest) break;
    }
}

void setDistances(IrradianceLevel& level, const Atlas& atlas, const std::vector<float>& nearness) {
    level.distanceTexels.clear();
    for (size_t node = 0; node < nearness.size(); ++node) {
        const float texelMeters = atlas.texelMetersAt(level.texel[node]);
        level.distanceTexels.push_back(1.0f / std::max(nearness[node] * texelMeters, 1e-30f));
    }
}

/// Whether one of a group's nodes or of its neighbours in the same chart has a small harmonic mean distance.
std::vector<uint8_t> groupsToSplit(const IrradianceLevel& level, const Atlas& atlas) {
    const glm::ivec2 size(level.size);
    std::vector<uint8_t> split(level.node.size(), 0);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const uint32_t chart = atlas.chartAt(glm::uvec2(x, y) * level.step);
            for (int i = 0; i < 9 && chart != kNoChart; ++i) {
                const glm::ivec2 p =
                    glm::clamp(glm::ivec2(x, y) + glm::ivec2(i % 3 - 1, i / 3 - 1), glm::ivec2(0), size - 1);
                if (atlas.chartAt(glm::uvec2(p) * level.step) != chart) continue;
                for (uint32_t n = level.node[size_t(p.y) * size.x + p.x]; n != kNoNode; n = level.next[n])
                    if (level.distanceTexels[n] < kSplitBelowSteps * float(level.step))
                        split[size_t(y) * size.x + x] = 1;
            }
        }
    return split;
}

/// Appends a finer level to `levels`, gathered in the light of `map`.
ResumableTask refine(const GatherContext& context, const Gatherer& gatherer,
                     std::vector<IrradianceLevel>& levels, uint32_t step, const IrradianceMap& map,
                     const ChartSet& charts) {
    const Atlas& atlas = context.input.atlas;
    const IrradianceLevel& coarse = levels.back();
    const std::vector<uint8_t> split = groupsToSplit(coarse, atlas);
    const uint32_t ratio = coarse.step / step;
    IrradianceLevel level = makeLevel(context.input.receivers(), step, [&](glm::uvec2 group) {
        const glm::uvec2 around = group / ratio;
        const size_t index = size_t(around.y) * coarse.size.x + around.x;
        return coarse.node[index] != kNoNode && split[index] != 0 &&
               hasChart(charts, atlas.chartAt(group * step));
    });
    std::vector<NodeSum> sums(level.texel.size());
    const auto sumOf = [&](size_t node, uint64_t& rays) {
        sums[node] = gatherer.sumRays(level, node, map, rays);
    };
    const size_t most = itemsPerSlice(context.sliceWork, kFineRays);
    if (sums.size() <= most) {
        const ProgressStage stage(context.progress, "diffuse contacts", sums.size());
        const uint64_t before = context.rayCount;
        fillParts(sums, hashOf(uint64_t(GatherStage::indirectIrradiance), step), context, sumOf);
        co_yield context.rayCount - before;
    } else {
        SilentProgress silent;
        for (size_t first = 0, last = 0; first < sums.size(); first = last) {
            last = first + std::min(most, sums.size() - first);
            std::atomic<uint64_t> sliceRays = 0;
            parallelRanges(last - first, 32, silent, [&](size_t begin, size_t end) {
                uint64_t rays = 0;
                for (size_t node = first + begin; node < first + end; ++node) sumOf(node, rays);
                sliceRays += rays;
            });
            context.rayCount += sliceRays;
            co_yield sliceRays.load();
        }
    }
    std::vector<float> nearness;
    for (const NodeSum& sum : sums) {
        level.value.push_back(sum.irradiance);
        nearness.push_back(sum.nearness);
    }
    setDistances(level, atlas, nearness);
    levels.push_back(std::move(level));
}

}  // namespace

IrradianceLevel coarseLevel(const GatherInput& input) {
    return makeLevel(input.receivers(), kLevelSteps[0], [](glm::uvec2) { return true; });
}

NodeRays traceNode(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                   const BakeSettings& settings, const IrradianceLevel& level, size_t node, uint64_t& rays) {
    return Gatherer{input, areaIrradiance, settings}.keepRays(level, node, rays);
}

ResumableTask irradianceFromNodes(GatherContext context, const std::vector<uint32_t>& areaIrradiance,
                                  IrradianceLevel coarse, std::vector<NodeRays> nodes, IrradianceMap& map) {
    const Atlas& atlas = context.input.atlas;
    const TexelPoints& points = context.input.points;
    const Gatherer gatherer{context.input, areaIrradiance, context.settings};
    const ChartSet all;
    std::vector<float> nearness;
    for (const NodeRays& node : nodes) nearness.push_back(node.nearness);
    setDistances(coarse, atlas, nearness);
    for (ResumableTask task =
             solve(coarse, nodes, context.input, context.settings.maxBounces - 1, context.progress);
         task.next();)
        co_yield task.work();

    std::vector<IrradianceLevel> levels;
    levels.push_back(std::move(coarse));
    IrradianceMap lit;
    for (ResumableTask task = interpolateLevels(levels, atlas, points, all, lit, context.sliceWork);
         task.next();)
        co_yield task.work();
    // The last bounce takes the irradiance of the very texel that is hit.
    levels[0].value = bounce(nodes, context.progress, [&](uint32_t texel) { return lit[texel]; });
    nodes = {};
    for (ResumableTask task = interpolateLevels(levels, atlas, points, all, lit, context.sliceWork);
         task.next();)
        co_yield task.work();
    for (size_t i = 1; i < std::size(kLevelSteps); ++i)
        for (ResumableTask task = refine(context, gatherer, levels, kLevelSteps[i], lit, all); task.next();)
            co_yield task.work();
    for (ResumableTask task = interpolateLevels(levels, atlas, points, all, map, context.sliceWork);
         task.next();)
        co_yield task.work();
}

ResumableTask irradianceOfCharts(GatherContext context, TexelIrradiance irradiance, IrradianceLevel coarse,
                                 const std::vector<NodeRays>& nodes, const ChartSet& charts,
                                 IrradianceMap& map) {
    const Atlas& atlas = context.input.atlas;
    const TexelPoints& points = context.input.points;
    const Gatherer gatherer{context.input, irradiance.area, context.settings};
    const auto before = [&](size_t texel) { return unpackRgb9e5(irradiance.indirect[texel]); };
    std::vector<float> nearness;
    for (const NodeRays& node : nodes) nearness.push_back(node.nearness);
    setDistances(coarse, atlas, nearness);
    coarse.value.assign(nodes.size(), glm::vec3(0));
    for (size_t n = 0; n < nodes.size(); ++n)
        if (hasChart(charts, atlas.chartAt(size_t(coarse.texel[n]))))
            coarse.value[n] = bounced(nodes[n], before);

    std::vector<IrradianceLevel> levels;
    levels.push_back(std::move(coarse));
    IrradianceMap lit;
    for (ResumableTask task = interpolateLevels(levels, atlas, points, charts, lit, context.sliceWork);
         task.next();)
        co_yield task.work();
    for (size_t texel = 0; texel < lit.size(); ++texel)
        if (!hasChart(charts, atlas.chartAt(texel))) lit[texel] = before(texel);
    for (size_t i = 1; i < std::size(kLevelSteps); ++i)
        for (ResumableTask task = refine(context, gatherer, levels, kLevelSteps[i], lit, charts);
             task.next();)
            co_yield task.work();
    for (ResumableTask task = interpolateLevels(levels, atlas, points, charts, map, context.sliceWork);
         task.next();)
        co_yield task.work();
}

IrradianceMap gatherIndirectIrradiance(const GatherContext& context,
                                       const std::vector<uint32_t>& areaIrradiance) {
    IrradianceLevel coarse = coarseLevel(context.input);
    std::vector<NodeRays> nodes(coarse.texel.size());
    {
        const ProgressStage stage(context.progress, "diffuse light", nodes.size());
        fillParts(nodes, hashOf(uint64_t(GatherStage::indirectIrradiance), coarse.step), context,
                  [&](size_t node, uint64_t& rays) {
                      nodes[node] =
                          traceNode(context.input, areaIrradiance, context.settings, coarse, node, rays);
                  });
    }
    IrradianceMap map;
    finish(irradianceFromNodes(context, areaIrradiance, std::move(coarse), std::move(nodes), map));
    return map;
}

}  // namespace phat
