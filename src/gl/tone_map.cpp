// twin: shaders/lib/tone_map.glsl.

#include <cmath>

#include "gl/renderer.h"

namespace phat {
namespace {

// source: Hill 2016, "BakingLab" (ACES.hlsl): a fit of the reference rendering and output transforms. The
// matrices go from linear Rec. 709 to the curve's primaries and back; glm's columns.
glm::vec3 toneMapAces(glm::vec3 color) {
    const glm::mat3 in(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f,
                       0.83777f);
    const glm::mat3 out(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f, -0.07367f, -0.00605f,
                        1.07602f);
    const glm::vec3 v = in * color;
    const glm::vec3 fit =
        (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
    return glm::clamp(out * fit, 0.0f, 1.0f);
}

// source: Sobotka 2022, "AgX": colours are drawn toward grey, log2-encoded between -12.47 and +4.03 stops
// around middle grey, put through a sigmoid and drawn back. The sigmoid is the sixth-order fit of Wrensch
// 2023, "Minimal AgX Implementation". The result is encoded for a display with gamma 2.2.
glm::vec3 toneMapAgx(glm::vec3 color) {
    const glm::mat3 inset(0.842479062253094f, 0.0423282422610123f, 0.0423756549057051f,  //
                          0.0784335999999992f, 0.878468636469772f, 0.0784336f,           //
                          0.0792237451477643f, 0.0791661274605434f, 0.879142973793104f);
    const glm::mat3 outset(1.19687900512017f, -0.0528968517574562f, -0.0529716355144438f,  //
                           -0.0980208811401368f, 1.15190312990417f, -0.0980434501171241f,  //
                           -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f);
    constexpr float kMinStops = -12.47393f, kMaxStops = 4.026069f;
    const glm::vec3 stops = glm::log2(glm::max(inset * color, glm::vec3(1e-10f)));
    const glm::vec3 x = glm::clamp((stops - kMinStops) / (kMaxStops - kMinStops), 0.0f, 1.0f);
    const glm::vec3 s =
        (((((15.5f * x - 40.14f) * x + 31.96f) * x - 6.868f) * x + 0.4298f) * x + 0.1191f) * x - 0.00232f;
    return glm::pow(glm::clamp(outset * s, 0.0f, 1.0f), glm::vec3(2.2f));
}

}  // namespace

Image toneMap(const Image& image, ToneMap operation, float exposureStops) {
    Image mapped = image;
    const float exposure = std::exp2(exposureStops);
    for (glm::vec3& pixel : mapped.pixels) {
        const glm::vec3 color = glm::max(pixel * exposure, glm::vec3(0));
        switch (operation) {
            case ToneMap::linear:
                pixel = glm::min(color, glm::vec3(1));
                break;
            case ToneMap::agx:
                pixel = toneMapAgx(color);
                break;
            case ToneMap::aces:
                pixel = toneMapAces(color);
                break;
        }
    }
    return mapped;
}

}  // namespace phat
