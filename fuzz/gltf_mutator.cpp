#include "glb_parts.h"
#include "targets.h"

namespace phat::fuzz {
namespace {

// Mostly of the same length, since all that looks at the bytes counts on their places.
void mutateBinary(GlbParts& parts, Rng& rng) {
    constexpr size_t kMaxGrowth = 64;  // bytes
    std::vector<uint8_t>& binary = parts.binary;
    const size_t size = binary.size();
    binary.resize(oneIn(rng, 4) ? size + kMaxGrowth : size);
    binary.resize(mutateBytes(binary.data(), size, binary.size(), rng.bits()));
    const auto buffers = parts.json.find("buffers");
    if (oneIn(rng, 4) || buffers == parts.json.end() || !buffers->is_array() || buffers->empty()) return;
    if ((*buffers)[0].is_object()) (*buffers)[0]["byteLength"] = binary.size();
}

}  // namespace

size_t mutateGltf(uint8_t* data, size_t size, size_t maxSize, unsigned seed) {
    Rng rng(seed);
    std::optional<GlbParts> parts = partsOfGlb({data, size});
    if (!parts || oneIn(rng, 8)) return mutateBytes(data, size, maxSize, seed);
    const bool binaryToo = !parts->binary.empty() && oneIn(rng, 3);
    if (binaryToo) mutateBinary(*parts, rng);
    if (!binaryToo || oneIn(rng, 3)) mutateJson(parts->json, rng);
    const size_t written = writeGlb(*parts, data, maxSize);
    return written > 0 ? written : mutateBytes(data, size, maxSize, seed);
}

}  // namespace phat::fuzz
