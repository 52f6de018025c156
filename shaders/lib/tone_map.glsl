// Scene-linear to display-linear [0,1].
// twin: toneMap in src/gl/renderer.h, with its sources; tests/gl compares the two.

const int kToneMapLinear = 0;
const int kToneMapAgx = 1;
const int kToneMapAces = 2;

// Columns as GLSL stores them: each vec3 below is one column.
vec3 toneMapAces(vec3 color) {
    const mat3 kIn = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 kOut = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    vec3 v = kIn * color;
    vec3 fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return clamp(kOut * fit, 0.0, 1.0);
}

// Sobotka's AgX: colours are drawn toward grey, log2-encoded, put through a sigmoid and drawn back.
// The sigmoid is Wrensch's sixth-order fit.
vec3 toneMapAgx(vec3 color) {
    const mat3 kInset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,  //
                             0.0784335999999992, 0.878468636469772, 0.0784336,           //
                             0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 kOutset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438,  //
                              -0.0980208811401368, 1.15190312990417, -0.0980434501171241,  //
                              -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    const float kMinStops = -12.47393, kMaxStops = 4.026069;
    vec3 stops = log2(max(kInset * color, vec3(1e-10)));
    vec3 x = clamp((stops - kMinStops) / (kMaxStops - kMinStops), 0.0, 1.0);
    vec3 s = (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232;
    vec3 encoded = clamp(kOutset * s, 0.0, 1.0);
    return pow(encoded, vec3(2.2));
}

vec3 toneMap(vec3 color, int operation, float exposureStops) {
    color = max(color * exp2(exposureStops), vec3(0.0));
    if (operation == kToneMapAces) return toneMapAces(color);
    if (operation == kToneMapAgx) return toneMapAgx(color);
    return min(color, vec3(1.0));
}
