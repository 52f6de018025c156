// Pass 2b, one texel a tile: how wide the display pass's cone must be there.
//
// Grows a square of tiles until it holds enough samples; the cone's radius is the one whose fraction of the square's
// area holds the target number. For indirect light and surrounding lights that is the number expected under the lobe
// (relight.frag), for small area lights the effective number (sum a L)^2 / sum (a L)^2 of what was found, so that
// highlights stay as sharp as they are. The radius is bounded by the distance of what is reflected, because a lobe
// smeared over the neighbourhood leaks light at contacts.
#include "lib/cone.glsl"
#include "lib/lit_fraction.glsl"

uniform sampler2DArray pyramid;
uniform sampler2DArray statistics;
uniform int lobeIndex;
uniform sampler2D tileLight;  // rgb: the bound of the radiance around, a: fraction of the solid angle with area lights
uniform int areaLights;       // 1: a lobe of the area lights

layout(location = 0) out vec4 radiusBound;

// Measured on tabletop and cornell-glossy with 600,000 texels: 32 and 8 give relMSE .103 and .026, these .069 and
// .028; fewer leave discs of single samples.
const float kSamplesPerCone = 16.0;
// Below this many samples noise is worse than a leak, so the bound by distance gives way.
const float kMinSamples = 4.0;
// Without reconnection a radius beyond a quarter of the distance leaks (docs/reference.md).
const float kRadiusPerDistance = 0.25;

// Whether relight.frag counted the tile's samples by expectation.
bool countsExpected(ivec2 tile) {
    float lit = texelFetch(tileLight, tile, 0).a;
    return areaLights == 0 || smoothstep(kMinLitFraction, kMaxLitFraction, lit) >= kCountsExpected;
}

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    radiusBound = vec4(0.0);
    uint chart = chartOfTile(tile);
    if (chart == kNoChart) return;

    radiusBound.gba = texelFetch(tileLight, tile, 0).rgb;
    bool expected = countsExpected(tile);
    float weight = 0.0, light = 0.0, count = 0.0, perMeter = 0.0, samples = 0.0, texels = 0.0;
    for (int ring = 0; ring <= int(kRadiusInTaps); ++ring) {
        for (int y = -ring; y <= ring; ++y) {
            // Only the square's border is new.
            int stride = abs(y) == ring ? 1 : max(2 * ring, 1);
            for (int x = -ring; x <= ring; x += stride) {
                ivec2 at = tile + ivec2(x, y);
                if (chartOfTile(at) != chart || countsExpected(at) != expected) continue;
                vec2 s = texelFetch(statistics, ivec3(at, lobeIndex), kTopLevel).rg;
                vec4 sums = texelFetch(pyramid, ivec3(at, lobeIndex), kTopLevel);
                weight += sums.a;
                light += dot(sums.rgb, vec3(0.2126, 0.7152, 0.0722));
                count += s.x;
                perMeter += s.y;
                texels += float(kTileSize * kTileSize);
            }
        }
        samples = expected ? count : count > 0.0 ? light * light / count : 0.0;
        if (samples >= kSamplesPerCone) break;
    }
    if (samples <= 0.0) {
        // No indirect sample under the lobe: the widest cone. No area light: there is nothing to smooth.
        radiusBound.r = expected ? kMaxRadius : kMinRadius;
        return;
    }
    // A cone's effective area is (sum k)^2 / sum k^2 = pi R^2 (1/3)^2 / (1/6) = 2/3 pi R^2.
    float perSample = sqrt(texels / samples * 1.5 / 3.14159265);
    float distanceTexels = weight / max(perMeter, 1e-20 * weight + 1e-30) / texelSizeOfTile(tile);
    float target = perSample * sqrt(kSamplesPerCone);
    float least = perSample * sqrt(kMinSamples);
    radiusBound.r = clamp(max(min(target, kRadiusPerDistance * distanceTexels), least), kMinRadius, kMaxRadius);
}
