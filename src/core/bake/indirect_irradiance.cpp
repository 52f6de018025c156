// Diffuse indirect light by rays that end in the irradiance of the texels themselves.

#include "core/bake/indirect_irradiance.h"

#include "core/bake/gather_parts.h"
#include "core/bake/irradiance_ray.h"
#include "core/bake/irradiance_split.h"

namespace phat {
namespace {

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

    template <uint32_t kRays>
    LinkedRays<kRays> keepRays(const IrradianceLevel& level, size_t node, uint64_t& rays) const {
        LinkedRays<kRays> kept;
        kept.texel.fill(kNoTexel);
        kept.weight.fill(0);
        glm::vec3 weights(0), rounded(0);
        kept.count = trace(level, node, kRays, rays, [&](uint32_t i, const IrradianceRay& ray) {
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

template <uint32_t kRays, typename IrradianceOf>
glm::vec3 bounced(const LinkedRays<kRays>& node, const IrradianceOf& irradianceOf) {
    glm::vec3 linked(0);
    for (uint32_t i = 0; i < node.count; ++i)
        if (node.texel[i] != kNoTexel) linked += unpackRgb9e5(node.weight[i]) * irradianceOf(node.texel[i]);
    return (node.light + node.unrounded * linked) * (kPi / float(std::max(node.count, 1u)));
}

/// Irradiance at the nodes when the texels have that which `irradianceOf` says.
template <uint32_t kRays, typename IrradianceOf>
std::vector<glm::vec3> bounce(const std::vector<LinkedRays<kRays>>& nodes, Progress& progress,
                              const IrradianceOf& irradianceOf) {
    std::vector<glm::vec3> next(nodes.size());
    SilentProgress silent;
    parallelRanges(nodes.size(), 1024, silent, [&](size_t begin, size_t end) {
        progress.throwIfStopped();
        for (size_t n = begin; n < end; ++n) next[n] = bounced(nodes[n], irradianceOf);
    });
    return next;
}

/// The nodes that light bounces between: all of the coarsest level, and those that the level after it has.
struct LinkedNodes {
    std::vector<NodeRays> coarse;
    std::vector<FineNodeRays> fine;

    size_t size() const { return coarse.size() + fine.size(); }
};

/// One bounce of each level's nodes.
template <typename IrradianceOf>
void bounceInto(std::vector<IrradianceLevel>& levels, const LinkedNodes& nodes, Progress& progress,
                const IrradianceOf& irradianceOf) {
    std::vector<glm::vec3> coarse = bounce(nodes.coarse, progress, irradianceOf);
    if (levels.size() > 1) levels[1].value = bounce(nodes.fine, progress, irradianceOf);
    levels[0].value = std::move(coarse);
}

/// Of a texel's piece and group: its finest node.
struct NodeOfTexel {
    uint32_t level = 0, node = kNoNode;
};

/// [y][x]
std::vector<NodeOfTexel> nodesOfTexels(const std::vector<IrradianceLevel>& levels, const GatherInput& input) {
    std::vector<NodeOfTexel> nodes(input.atlas.texelCount());
    SilentProgress silent;
    parallelRanges(nodes.size(), 4096, silent, [&](size_t begin, size_t end) {
        for (size_t texel = begin; texel < end; ++texel)
            for (uint32_t level = 0; level < levels.size(); ++level) {
                const uint32_t node = levels[level].nodeOf(input.atlas, input.points, uint32_t(texel));
                if (node != kNoNode) nodes[texel] = {level, node};
            }
    });
    return nodes;
}

/// Light bounces between the nodes, each hit taking that of the finest node of its group and piece, until
/// nothing changes or all bounces are used up.
ResumableTask solve(std::vector<IrradianceLevel>& levels, const LinkedNodes& nodes, const GatherInput& input,
                    int bounces, Progress& progress) {
    for (IrradianceLevel& level : levels) level.value.assign(level.texel.size(), glm::vec3(0));
    const std::vector<NodeOfTexel> nodeOf = nodesOfTexels(levels, input);
    std::vector<std::vector<glm::vec3>> value(levels.size());
    for (int i = 0; i < bounces; ++i) {
        for (size_t level = 0; level < levels.size(); ++level) value[level] = std::move(levels[level].value);
        bounceInto(levels, nodes, progress, [&](uint32_t texel) {
            const NodeOfTexel at = nodeOf[texel];
            return at.node != kNoNode ? value[at.level][at.node] : glm::vec3(0);
        });
        float change = 0, largest = 0;
        for (size_t level = 0; level < levels.size(); ++level)
            for (size_t n = 0; n < value[level].size(); ++n) {
                change = std::max(change, maxComponent(levels[level].value[n] - value[level][n]));
                largest = std::max(largest, maxComponent(levels[level].value[n]));
            }
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

/// Fills `results` of a level's nodes by traceOne(node, rays).
template <typename Value, typename TraceOne>
ResumableTask traceLevel(const GatherContext& context, const IrradianceLevel& level,
                         std::vector<Value>& results, TraceOne traceOne) {
    results.resize(level.texel.size());
    const size_t most = itemsPerSlice(context.sliceWork, kFineRays);
    if (results.size() <= most) {
        const ProgressStage stage(context.progress, "diffuse contacts", results.size());
        const uint64_t before = context.rayCount;
        fillParts(results, hashOf(uint64_t(GatherStage::indirectIrradiance), level.step), context,
                  [&](size_t node, uint64_t& rays) { results[node] = traceOne(node, rays); });
        co_yield context.rayCount - before;
        co_return;
    }
    SilentProgress silent;
    for (size_t first = 0, last = 0; first < results.size(); first = last) {
        last = first + std::min(most, results.size() - first);
        std::atomic<uint64_t> sliceRays = 0;
        parallelRanges(last - first, 32, silent, [&](size_t begin, size_t end) {
            uint64_t rays = 0;
            for (size_t node = first + begin; node < first + end; ++node)
                results[node] = traceOne(node, rays);
            sliceRays += rays;
        });
        context.rayCount += sliceRays;
        co_yield sliceRays.load();
    }
}

template <typename Nodes>
std::vector<float> nearnessOf(const Nodes& nodes) {
    std::vector<float> nearness;
    for (const auto& node : nodes) nearness.push_back(node.nearness);
    return nearness;
}

/// Appends a finer level to `levels`, gathered in the light of `map`.
ResumableTask refine(const GatherContext& context, const Gatherer& gatherer,
                     std::vector<IrradianceLevel>& levels, uint32_t step, const IrradianceMap& map,
                     const ChartSet& charts) {
    IrradianceLevel level = finerLevel(context.input.receivers(), levels.back(), step, map, charts);
    std::vector<NodeSum> sums;
    for (ResumableTask task =
             traceLevel(context, level, sums,
                        [&](size_t node, uint64_t&rays) { return gatherer.sumRays(level, node, map, rays); });
         task.next();)
        co_yield task.work();
    for (const NodeSum& sum : sums) level.value.push_back(sum.irradiance);
    setDistances(level, context.input.atlas, nearnessOf(sums));
    levels.push_back(std::move(level));
}

}  // namespace

IrradianceLevel coarseLevel(const GatherInput& input) {
    return makeLevel(input.receivers(), kLevelSteps[0], [](glm::uvec2) { return true; });
}

NodeRays traceNode(const GatherInput& input, const std::vector<uint32_t>& areaIrradiance,
                   const BakeSettings& settings, const IrradianceLevel& level, size_t node, uint64_t& rays) {
    return Gatherer{input, areaIrradiance, settings}.keepRays<kNodeRays>(level, node, rays);
}

ResumableTask irradianceFromNodes(GatherContext context, const std::vector<uint32_t>& areaIrradiance,
                                  IrradianceLevel coarse, std::vector<NodeRays> coarseNodes,
                                  IrradianceMap& map) {
    const Atlas& atlas = context.input.atlas;
    const TexelPoints& points = context.input.points;
    const Gatherer gatherer{context.input, areaIrradiance, context.settings};
    const ChartSet all;
    LinkedNodes nodes{std::move(coarseNodes), {}};
    std::vector<IrradianceLevel> levels;
    IrradianceMap lit;
    const auto interpolate = [&](IrradianceMap& target) {
        return interpolateLevels(levels, atlas, points, all, target, context.sliceWork);
    };
    const auto solveInto = [&]() {
        return solve(levels, nodes, context.input, context.settings.maxBounces - 1, context.progress);
    };
    setDistances(coarse, atlas, nearnessOf(nodes.coarse));
    levels.push_back(std::move(coarse));
    for (ResumableTask task = solveInto(); task.next();) co_yield task.work();
    for (ResumableTask task = interpolate(lit); task.next();) co_yield task.work();

    // Between surfaces that are close to each other light bounces often, and would spread along them by as
    // much as the coarsest nodes are apart, each time.
    IrradianceLevel fine = finerLevel(context.input.receivers(), levels[0], kLevelSteps[1], lit, all);
    for (ResumableTask task = traceLevel(
             context, fine, nodes.fine,
             [&](size_t node, uint64_t&rays) { return gatherer.keepRays<kFineRays>(fine, node, rays); });
         task.next();)
        co_yield task.work();
    setDistances(fine, atlas, nearnessOf(nodes.fine));
    levels.push_back(std::move(fine));
    for (ResumableTask task = solveInto(); task.next();) co_yield task.work();
    for (ResumableTask task = interpolate(lit); task.next();) co_yield task.work();
    // The last bounce takes the irradiance of the very texel that is hit.
    bounceInto(levels, nodes, context.progress, [&](uint32_t texel) { return lit[texel]; });
    nodes = {};
    for (ResumableTask task = interpolate(lit); task.next();) co_yield task.work();
    for (ResumableTask task = refine(context, gatherer, levels, kLevelSteps[2], lit, all); task.next();)
        co_yield task.work();
    for (ResumableTask task = interpolate(map); task.next();) co_yield task.work();
}

ResumableTask irradianceOfCharts(GatherContext context, TexelIrradiance irradiance, IrradianceLevel coarse,
                                 const std::vector<NodeRays>& nodes, const ChartSet& charts,
                                 IrradianceMap& map) {
    const Atlas& atlas = context.input.atlas;
    const TexelPoints& points = context.input.points;
    const Gatherer gatherer{context.input, irradiance.area, context.settings};
    const auto before = [&](size_t texel) { return unpackRgb9e5(irradiance.indirect[texel]); };
    setDistances(coarse, atlas, nearnessOf(nodes));
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
