#pragma once
// A scene with KHR_materials_variants.

#include <string>

namespace phat {

/// A .gltf: a triangle, oak or, in the variant "dark", walnut, that emits light of its own.
inline std::string sceneWithVariants() {
    return R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_variants"],
        "extensions":{"KHR_materials_variants":{"variants":[{"name":"dark"},{"name":"as it is"}]}},
        "scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0,"extensions":{"KHR_materials_variants":
            {"mappings":[{"material":1,"variants":[0]}]}}}]}],
        "materials":[{"name":"oak","emissiveFactor":[1,1,1]},{"name":"walnut","emissiveFactor":[0.1,0.1,0.1]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

}  // namespace phat
