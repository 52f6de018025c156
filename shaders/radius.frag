// Pass 2b, one texel a tile: how wide the display pass's cone must be there.
//
// Grows a square of tiles until it holds enough effective samples, N = (sum a)^2 / sum a^2; the cone's radius
// is the one whose share of the square's area holds the wanted number. It is bounded by the distance of what
// is reflected, because a lobe smeared over the neighbourhood leaks light where things touch.
#include "lib/cone.glsl"

uniform sampler2DArray pyramid;
uniform sampler2DArray statistics;
uniform int lobeIndex;
uniform float texelSizeMeters;

layout(location = 0) out float radius;

// From pictures: fewer samples are noisy, more blur what roughness .2 to .6 should show.
const float kWantedSamples = 12.0;
// Below this many samples noise is worse than a leak, so the bound by distance gives way.
const float kLeastSamples = 3.0;
// Without reconnection a radius beyond a quarter of the distance leaks (docs/pipeline.md).
const float kRadiusPerDistance = 0.25;

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    radius = 0.0;
    uint chart = chartOfTile(tile);
    if (chart == kNoChart) return;

    float a = 0.0, aa = 0.0, aPerMeter = 0.0, samples = 0.0, texels = 0.0;
    for (int ring = 0; ring <= int(kRadiusInTaps); ++ring) {
        for (int y = -ring; y <= ring; ++y) {
            // Only the square's border is new.
            int stride = abs(y) == ring ? 1 : max(2 * ring, 1);
            for (int x = -ring; x <= ring; x += stride) {
                ivec2 at = tile + ivec2(x, y);
                if (chartOfTile(at) != chart) continue;
                vec2 s = texelFetch(statistics, ivec3(at, lobeIndex), kTopLevel).rg;
                a += texelFetch(pyramid, ivec3(at, lobeIndex), kTopLevel).a;
                aa += s.x;
                aPerMeter += s.y;
                texels += float(kTileSize * kTileSize);
            }
        }
        samples = aa > 0.0 ? a * a / aa : 0.0;
        if (samples >= kWantedSamples) break;
    }
    if (samples <= 0.0) {
        radius = kMaxRadius;
        return;
    }
    // A cone's effective area is (sum k)^2 / sum k^2 = pi R^2 (1/3)^2 / (1/6) = 2/3 pi R^2.
    float perSample = sqrt(texels / samples * 1.5 / 3.14159265);
    float distanceTexels = a / max(aPerMeter, 1e-20 * a) / texelSizeMeters;
    float wanted = perSample * sqrt(kWantedSamples);
    float least = perSample * sqrt(kLeastSamples);
    radius = clamp(max(min(wanted, kRadiusPerDistance * distanceTexels), least), kMinRadius, kMaxRadius);
}
