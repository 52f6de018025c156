// Photons as they leave the lights.

#include <array>
#include <cassert>

#include "core/scene/light_punctual.h"
#include "core/scene/lights.h"

namespace phat {
namespace {

// Streams of hashOf.
constexpr uint64_t kAllotmentStream = 0x5a01, kSequenceStream = 0x5a02;

// Positive root of x^(d+1) = x + 1, by Newton's method.
constexpr double generalizedGolden(int dimensions) {
    double x = 1.5;
    for (int step = 0; step < 32; ++step) {
        double power = 1;
        for (int i = 0; i < dimensions; ++i) power *= x;
        x -= (power * x - x - 1) / ((dimensions + 1) * power - 1);
    }
    return x;
}

// Point `index` of a low-discrepancy sequence in [0,1)^d, shifted at random by `stream`. 64-bit fixed point
// keeps it exact for any index. source: Roberts 2018, "The Unreasonable Effectiveness of Quasirandom
// Sequences".
template <int dimensions>
std::array<float, dimensions> lowDiscrepancy(uint64_t index, uint64_t stream) {
    constexpr double inverse = 1.0 / generalizedGolden(dimensions);
    std::array<float, dimensions> point;
    double alpha = 1;
    for (int i = 0; i < dimensions; ++i) {
        alpha *= inverse;
        const uint64_t fixed = hashOf(stream, uint64_t(i)) + index * uint64_t(alpha * 0x1p64);
        point[i] = float(fixed >> 40) * 0x1p-24f;
    }
    return point;
}

std::array<float, 4> withZeros(std::array<float, 2> point) {
    return {point[0], point[1], 0, 0};
}

// The cosine-weighted hemisphere is the uniform disk lifted up (Malley's method).
glm::vec2 squareToDisk(glm::vec2 square) {
    return glm::vec2(squareToCosineHemisphere(square));
}

glm::vec3 directionAt(float cosine, float azimuth) {
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

// From a disk that covers the scene, just outside of the sphere around it.
glm::vec3 originBeforeScene(glm::vec3 center, float radius, glm::vec3 direction, glm::vec2 square) {
    const glm::vec2 disk = radius * squareToDisk(square);
    const Frame frame = frameFromNormal(direction);
    return center - 1.01f * radius * direction + disk.x * frame.tangent + disk.y * frame.bitangent;
}

}  // namespace

// Photon `within` of its source's own; each carries the source's power times `powerFraction`.
struct LightSampler::PhotonTurn {
    size_t source = 0;
    uint64_t within = 0;
    uint64_t total = 1;  // photons of the source
    double powerFraction = 0;
    uint64_t stream = 0;
};

void LightSampler::addPhotonSources() {
    std::vector<double> weights;
    for (uint32_t i = 0; i < scene_->lights.size(); ++i) {
        sources_.push_back({PhotonSource::Kind::punctual, i, i + 1});
        weights.push_back(std::max(0.0f, luminance(punctualPower(scene_->lights[i], sceneRadius_))));
    }
    for (uint32_t first = 0, end; first < emitters_.size(); first = end) {
        const auto surface = [&](uint32_t i) { return scene_->triangleSurface[emitters_[i].triangle]; };
        for (end = first + 1; end < emitters_.size() && surface(end) == surface(first);) ++end;
        sources_.push_back({PhotonSource::Kind::triangles, first, end});
        weights.push_back(emitterChoice_.cumulated(end) - emitterChoice_.cumulated(first));
    }
    if (environment_) {
        sources_.push_back({PhotonSource::Kind::environment});
        weights.push_back(
            std::max(0.0f, kPi * square(sceneRadius_) * luminance(environment_->integratedRadiance())));
    }
    sourceChoice_ = DiscreteDistribution(weights);
}

// Systematic sampling: source s owns the integers in [boundary(s), boundary(s + 1)), one more or one less
// than its due by a common random shift. Dividing by the number that it got makes its sum exact.
LightSampler::PhotonTurn LightSampler::turnOf(uint64_t index, uint64_t count, uint64_t seed) const {
    const double shift = double(hashOf(seed, kAllotmentStream) >> 11) * 0x1p-53;
    const double perWatt = double(count) / sourceChoice_.total();
    const auto boundary = [&](size_t source) {
        if (source == sources_.size()) return count;
        return std::min(count, uint64_t(sourceChoice_.cumulated(source) * perWatt + shift));
    };
    // The last source that begins at or before the photon; it is not empty, as the next one begins after it.
    size_t low = 0, high = sources_.size();
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        (boundary(middle) <= index ? low : high) = middle;
    }
    PhotonTurn turn;
    turn.source = low;
    turn.within = index - boundary(low);
    turn.total = boundary(low + 1) - boundary(low);
    const double due = sourceChoice_.weight(low) * perWatt;
    // A source that is due less than one photon gets one now and then, which carries more than its power.
    turn.powerFraction = 1.0 / (due < 1.0 ? due : double(turn.total));
    turn.stream = hashOf(seed, kSequenceStream, low);
    return turn;
}

EmittedPhoton LightSampler::emitPhoton(uint64_t index, uint64_t count, uint64_t seed) const {
    assert(index < count);
    if (!(sourceChoice_.total() > 0)) return {};
    const PhotonTurn turn = turnOf(index, count, seed);
    const PhotonSource& source = sources_[turn.source];
    switch (source.kind) {
        case PhotonSource::Kind::punctual:
            return fromPunctual(source, turn);
        case PhotonSource::Kind::triangles:
            return fromTriangles(source, turn);
        case PhotonSource::Kind::environment:
            return fromEnvironment(turn);
    }
    return {};
}

EmittedPhoton LightSampler::fromPunctual(const PhotonSource& source, const PhotonTurn& turn) const {
    const PunctualLight& light = scene_->lights[source.first];
    const auto [u, v, discU, discV] = light.angularRadius > 0
                                          ? lowDiscrepancy<4>(turn.within, turn.stream)
                                          : withZeros(lowDiscrepancy<2>(turn.within, turn.stream));
    EmittedPhoton photon;
    photon.punctual = true;
    photon.rangeMeters = light.rangeMeters;
    photon.origin = light.position;
    photon.fluxWatts = punctualPower(light, sceneRadius_) * float(turn.powerFraction);
    switch (light.type) {
        case PunctualLight::Type::point:
            photon.direction =
                light.photometry ? samplePhotometry(light, {u, v}) : directionAt(1 - 2 * u, 2 * kPi * v);
            break;
        case PunctualLight::Type::spot: {
            const float cosine = sampleSpotCosine(spotCone(light), u);
            photon.direction = frameFromNormal(light.direction).toWorld(directionAt(cosine, 2 * kPi * v));
            break;
        }
        case PunctualLight::Type::directional:
            photon.direction = -sampleLightDisc(light, {discU, discV});
            photon.origin = originBeforeScene(sceneCenter_, sceneRadius_, photon.direction, {u, v});
            photon.rangeMeters = 0;
            break;
    }
    return photon;
}

EmittedPhoton LightSampler::fromTriangles(const PhotonSource& source, const PhotonTurn& turn) const {
    const auto [shift] = lowDiscrepancy<1>(0, turn.stream);
    const double unit = std::min((double(turn.within) + shift) / double(turn.total), 1 - 0x1p-53);
    const auto [index, within] = emitterChoice_.choose(unit, source.first, source.end);
    const EmissiveTriangle& emitter = emitters_[index];
    // A double-sided triangle's interval has two halves, one for each side.
    const bool back = emitter.doubleSided && within >= 0.5;
    const glm::vec3 normal = back ? -emitter.normal : emitter.normal;

    const auto [px, py, dx, dy] = lowDiscrepancy<4>(turn.within, turn.stream);
    const glm::vec2 barycentric = squareToTriangle({px, py});
    const double sourceWeight = emitterChoice_.cumulated(source.end) - emitterChoice_.cumulated(source.first);
    const double chance = emitterChoice_.weight(index) / sourceWeight;
    const glm::vec3 radiance =
        emitter.uniform ? emitter.radiance : emittedRadiance(*scene_, emitter, barycentric);
    EmittedPhoton photon;
    photon.direction = frameFromNormal(normal).toWorld(squareToCosineHemisphere({dx, dy}));
    photon.origin =
        offsetOrigin(pointOnTriangle(*scene_, emitter.triangle, barycentric), normal, unitMeters_);
    photon.fluxWatts = radiance * float(double(kPi) * emitter.areaSquareMeters * emitter.sides() *
                                        turn.powerFraction / chance);
    return photon;
}

EmittedPhoton LightSampler::fromEnvironment(const PhotonTurn& turn) const {
    const auto [ex, ey, dx, dy] = lowDiscrepancy<4>(turn.within, turn.stream);
    const EnvironmentSample found = environment_->sample({ex, ey});
    if (!(found.pdf > 0)) return {};
    EmittedPhoton photon;
    photon.direction = -found.direction;
    photon.origin = originBeforeScene(sceneCenter_, sceneRadius_, photon.direction, {dx, dy});
    photon.fluxWatts = environmentRadiance(found.direction) *
                       (kPi * square(sceneRadius_) * float(turn.powerFraction) / found.pdf);
    return photon;
}

}  // namespace phat
