#pragma once
// Common to the parts of the glTF loader: how they fail, how much memory they may use, what they report.

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace phat::gltf {

/// A file that cannot be loaded. loadGltf adds the path and throws FileError.
struct Problem : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Bounds what a small hostile file can make us allocate; large files may use in proportion to their size.
/// Everything whose size the file only claims (instances, pictures, counts) is charged before it is
/// allocated.
class MemoryBudget {
  public:
    explicit MemoryBudget(uint64_t inputBytes) : limit_(kBaseBytes) { allowFor(inputBytes); }

    /// Raises the limit for bytes that were really read.
    void allowFor(uint64_t inputBytes) { limit_ += kBytesPerInputByte * inputBytes; }
    uint64_t left() const { return limit_ - used_; }
    /// Throws Problem, naming `what`, when the limit would be passed.
    void charge(uint64_t bytes, const std::string& what);
    void release(uint64_t bytes) { used_ -= bytes; }

  private:
    // ours: a hostile file of a megabyte stays below 1 GB in all; 12 million triangles by instancing still
    // fit.
    static constexpr uint64_t kBaseBytes = 640ull << 20;
    // A 4096x4096 JPEG of 1.5 MB decodes to 64 MB: a ratio of 43.
    static constexpr uint64_t kBytesPerInputByte = 64;

    uint64_t limit_ = 0;
    uint64_t used_ = 0;
};

/// What LoadedScene::notes says, gathered so that each kind is one line.
struct Notes {
    std::vector<std::string> lines;
    uint64_t pointAndLinePrimitives = 0;
    uint64_t primitivesWithoutPositions = 0;
    uint64_t incompleteTriangles = 0;   // indices left over at the end of a triangle list
    uint64_t unplaceableTriangles = 0;  // with a corner that is not finite or absurdly far
    uint64_t repairedNormals = 0;
    uint64_t turnedNormals = 0;  // primitives
    uint64_t repairedTangents = 0;
    uint64_t repairedUvs = 0;
    uint64_t repairedColors = 0;
    uint64_t clampedFactors = 0;
    uint64_t skinnedMeshes = 0;
    uint64_t morphedMeshes = 0;
    uint64_t basisFallbacks = 0;
};

/// The counters as lines, after the lines that are already there.
std::vector<std::string> linesOf(const Notes& notes);

/// Bytes of a message that are shown: a parser quotes what it chokes on.
inline constexpr size_t kShownBytes = 300;

}  // namespace phat::gltf
