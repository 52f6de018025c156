// Mutations of glTF's JSON that keep it JSON.

#include <array>

#include "glb_parts.h"

namespace phat::fuzz {
namespace {

using nlohmann::json;

constexpr double kReals[] = {0, 1, -1, 0.5, 3.5, 1e-300, 1e300, 1e39, -1e39, 1e18, 1e-40, 1e10};
constexpr uint64_t kWholes[] = {
    0,     1,     2,   3,          4,           5,           8,          16,         31,   64,   127,
    128,   255,   256, 1000,       5120,        5121,        5122,       5123,       5125, 5126, 65528,
    65535, 65536, ~0u, 0x7fffffff, 0x80000000u, 0x100000000, 1ull << 52, 1ull << 53, ~0ull};
constexpr const char* kTexts[] = {"",
                                  "SCALAR",
                                  "VEC2",
                                  "VEC3",
                                  "VEC4",
                                  "MAT2",
                                  "MAT3",
                                  "MAT4",
                                  "LINEAR",
                                  "STEP",
                                  "OPAQUE",
                                  "CUBICSPLINE",
                                  "MASK",
                                  "BLEND",
                                  "point",
                                  "spot",
                                  "../x",
                                  "scale",
                                  "weights",
                                  "directional",
                                  "perspective",
                                  "orthographic",
                                  "translation",
                                  "rotation",
                                  "scene.glb",
                                  "image/png",
                                  "image/webp",
                                  "data:;base64,AAAA",
                                  "ATTRIBUTES",
                                  "OCTAHEDRAL",
                                  "packed",
                                  "paper"};
constexpr const char* kKeys[] = {"sparse",
                                 "byteStride",
                                 "byteOffset",
                                 "byteLength",
                                 "normalized",
                                 "indices",
                                 "material",
                                 "mode",
                                 "targets",
                                 "weights",
                                 "matrix",
                                 "translation",
                                 "rotation",
                                 "scale",
                                 "children",
                                 "mesh",
                                 "camera",
                                 "skin",
                                 "skins",
                                 "extensions",
                                 "KHR_lights_punctual",
                                 "KHR_texture_transform",
                                 "KHR_materials_clearcoat",
                                 "KHR_materials_specular",
                                 "KHR_materials_ior",
                                 "KHR_materials_emissive_strength",
                                 "KHR_materials_unlit",
                                 "KHR_materials_transmission",
                                 "KHR_materials_volume",
                                 "KHR_materials_variants",
                                 "KHR_mesh_quantization",
                                 "KHR_materials_pbrSpecularGlossiness",
                                 "KHR_draco_mesh_compression",
                                 "EXT_meshopt_compression",
                                 "EXT_mesh_gpu_instancing",
                                 "EXT_texture_webp",
                                 "uri",
                                 "bufferView",
                                 "TANGENT",
                                 "TEXCOORD_0",
                                 "TEXCOORD_1",
                                 "TEXCOORD_2",
                                 "COLOR_0",
                                 "JOINTS_0",
                                 "WEIGHTS_0",
                                 "extras",
                                 "name",
                                 "alphaMode",
                                 "alphaCutoff",
                                 "doubleSided",
                                 "normalTexture",
                                 "texCoord",
                                 "offset",
                                 "min",
                                 "max",
                                 "pdf",
                                 "scrambles",
                                 "texelCorrection",
                                 "environment",
                                 "distances",
                                 "irradiance",
                                 "probes",
                                 "bvh",
                                 "storage"};

template <class T, size_t n>
const T& oneOf(const T (&values)[n], Rng& rng) {
    return values[below(rng, n)];
}

json interestingValue(Rng& rng) {
    switch (below(rng, 8)) {
        case 0:
            return oneOf(kReals, rng);
        case 1:
            return -int64_t(below(rng, 5));
        case 2:
            return oneOf(kTexts, rng);
        case 3:
            return std::array<json, 4>{nullptr, json::array(), json::object(), true}[below(rng, 4)];
        case 4:
            return below(rng, 70);  // an index, mostly
        default:
            return oneOf(kWholes, rng);
    }
}

void collect(json& value, std::vector<json*>& all) {
    all.push_back(&value);
    if (!value.is_structured()) return;
    for (json& inner : value) collect(inner, all);
}

void changeInside(json& value, Rng& rng) {
    if (value.empty()) return;
    const size_t index = below(rng, value.size());
    if (value.is_array()) {
        if (oneIn(rng, 2))
            value.erase(index);
        else
            value.push_back(json(value[index]));
        return;
    }
    const auto member = std::next(value.begin(), ptrdiff_t(index));
    if (oneIn(rng, 2))
        value.erase(member);
    else
        *member = interestingValue(rng);
}

void changeOne(json& value, const std::vector<json*>& all, Rng& rng) {
    constexpr size_t kMaxCopiedBytes = 3000;
    switch (below(rng, 4)) {
        case 0:  // one more or less, or the opposite
            if (value.is_number_unsigned())
                value = value.get<uint64_t>() + (oneIn(rng, 2) ? 1 : ~0ull);
            else if (value.is_number())
                value = -value.get<double>();
            return;
        case 1:  // a part of the file in another place
            if (const json copy = *all[below(rng, all.size())];
                copy.dump(-1, ' ', false, json::error_handler_t::replace).size() < kMaxCopiedBytes)
                value = copy;
            return;
        case 2:
            if (value.is_object()) {
                const json copy = *all[below(rng, all.size())];
                value[oneOf(kKeys, rng)] = oneIn(rng, 2) ? interestingValue(rng) : copy;
                return;
            }
            [[fallthrough]];
        default:
            if (value.is_structured())
                changeInside(value, rng);
            else
                value = interestingValue(rng);
    }
}

}  // namespace

void mutateJson(json& root, Rng& rng) {
    for (size_t left = 1 + below(rng, 3); left > 0; --left) {
        std::vector<json*> all;
        collect(root, all);
        changeOne(*all[below(rng, all.size())], all, rng);
        if (!root.is_object()) root = json::object();
    }
}

}  // namespace phat::fuzz
