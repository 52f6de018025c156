// What rough glass shows of the picture behind it: the mean over directions that the light is scattered from. Where each
// of them leads in the picture follows from how far away things are there; what the picture does not show, because it
// is hidden or beside it, is taken from the nearest that it shows.
// twin: throughThin in src/core/scene/glass.cpp has the same directions.
#include "lib/visible_normal.glsl"
#include "lib/nearness.glsl"

uniform sampler2D behind;  // of behind.frag, with its smaller levels
uniform mat4 clipFromWorld;
uniform vec2 turn;  // of the points that directions are made of; another in each of several frames

const int kScatteredTaps = 16;
// A level's texels, themselves means of squares, are filtered linearly: the standard deviation is half of their side,
// that of a square .29 of its own.
const float kTexelOverSquare = 0.58;

vec2 scatteringPoint(int tap) {
    return fract(vec2((float(tap) + 0.5) / float(kScatteredTaps), 0.618034 * float(tap)) + turn);
}

// In the frame of the surface, away from the eye.
vec3 scatteredDirection(vec2 point, vec3 towardEye, float alpha) {
    vec3 h = squareToVisibleNormal(point, towardEye, alpha);
    vec3 reflected = 2.0 * dot(towardEye, h) * h - towardEye;
    return reflected.z > 0.0 ? vec3(reflected.xy, -reflected.z) : -towardEye;
}

// Where in the picture, in pixels, the ray from the glass along `direction` ends if what is there is `meters` behind the
// glass.
vec2 pixelBehind(VisibleSurface s, vec3 direction, float meters) {
    float along = max(-dot(direction, s.towardEye), 0.2);
    vec4 clip = clipFromWorld * vec4(vPosition + max(meters, 0.0) / along * direction, 1.0);
    if (clip.w <= 0.0) return gl_FragCoord.xy;
    return (0.5 + 0.5 * clip.xy / clip.w) * vec2(textureSize(behind, 0));
}

float metersBehindPixel(vec2 pixel, float level) {
    float near = textureLod(behind, pixel / vec2(textureSize(behind, 0)), level).a;
    return metersBehind(near, vPosition, eyeWorld, eyeAtInfinity);
}

// `alpha`: of the lobe that would scatter the same by reflection.
vec3 scatteredBehind(VisibleSurface s, float alpha) {
    float straight = metersBehindPixel(gl_FragCoord.xy, 0.0);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < kScatteredTaps; ++i) {
        vec2 point = scatteringPoint(i);
        vec3 direction = s.worldFromLocal * scatteredDirection(point, s.towardEyeLocal, alpha);
        vec2 pixel = pixelBehind(s, direction, straight);
        // Seen along the normal a tap at x of [0, 1] lies at alpha sqrt(x / (1 - x)) and stands for this part of the
        // plane, which the derivative of its area by x says.
        float x = clamp(point.x, 0.5 / float(kScatteredTaps), 1.0 - 0.5 / float(kScatteredTaps));
        float side = distance(pixel, gl_FragCoord.xy) * sqrt(kPi / (float(kScatteredTaps) * x * (1.0 - x)));
        float level = log2(max(kTexelOverSquare * side, 1.0));
        // What is there may be nearer or farther than what is straight behind.
        pixel = pixelBehind(s, direction, metersBehindPixel(pixel, level));
        vec4 shown = textureLod(behind, pixel / vec2(textureSize(behind, 0)), level);
        // Of things in front of the glass nothing is seen through it.
        float isBehind = step(0.0, metersBehind(shown.a, vPosition, eyeWorld, eyeAtInfinity));
        sum += isBehind * vec4(shown.rgb, 1.0);
    }
    if (sum.a > 0.0) return sum.rgb / sum.a;
    return textureLod(behind, gl_FragCoord.xy / vec2(textureSize(behind, 0)), 0.0).rgb;
}
