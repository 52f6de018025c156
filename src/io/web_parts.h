#pragma once
// A baked file in two parts, for pages that show the first while the second is on its way.

#include <cstdint>
#include <string>
#include <vector>

namespace phat {

struct WebParts {
    std::vector<uint8_t> room;         // a baked GLB: the scene, its diffuse light, and the atlas
    std::vector<uint8_t> reflections;  // a buffer of it: what only glossy light needs
};

/// `reflectionsUri`: the name, beside the first part, that the second will have. Together they are the same
/// baked file. Throws FileError.
WebParts splitForWeb(const std::string& path, const std::string& reflectionsUri);

}  // namespace phat
