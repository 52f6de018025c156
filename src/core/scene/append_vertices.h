#pragma once

#include "core/scene/scene.h"

namespace phat {

/// Appends all vertices of `from`, which has a scene's vertex arrays.
template <typename From>
void appendVertices(Scene& scene, const From& from) {
    const auto append = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
    append(scene.positions, from.positions);
    append(scene.normals, from.normals);
    append(scene.tangents, from.tangents);
    append(scene.uv0, from.uv0);
    append(scene.uv1, from.uv1);
    append(scene.colors, from.colors);
}

}  // namespace phat
