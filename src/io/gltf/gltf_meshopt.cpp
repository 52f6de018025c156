#include <fmt/format.h>
#include <meshoptimizer.h>

#include <initializer_list>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_plain.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

struct Stream {
    std::span<const uint8_t> bytes;
    uint64_t count, stride;
    std::string mode, filter;

    uint64_t size() const { return count * stride; }
};

Stream streamOf(const GltfSource& source, const json& compressed) {
    Stream stream{{},
                  wholeNumber(compressed, "count"),
                  wholeNumber(compressed, "byteStride"),
                  compressed.value("mode", "ATTRIBUTES"),
                  compressed.value("filter", "NONE")};
    const std::span<const uint8_t> buffer = bufferBytes(source, wholeNumber(compressed, "buffer"));
    const uint64_t offset = wholeNumber(compressed, "byteOffset", 0);
    const uint64_t length = wholeNumber(compressed, "byteLength");
    if (offset > buffer.size() || length > buffer.size() - offset)
        throw Problem("its compressed data lie outside their buffer");
    stream.bytes = buffer.subspan(offset, length);
    const bool attributes = stream.mode == "ATTRIBUTES";
    const bool known = attributes || stream.mode == "TRIANGLES" || stream.mode == "INDICES";
    if (!known) throw Problem(fmt::format("its mode \"{}\" does not exist", stream.mode));
    // What the decoder takes for granted.
    const bool strided = attributes ? stream.stride > 0 && stream.stride <= 256 && stream.stride % 4 == 0
                                    : stream.stride == 2 || stream.stride == 4;
    if (!strided || stream.count > UINT32_MAX) throw Problem("its stride or count is out of range");
    if (stream.mode == "TRIANGLES" && stream.count % 3 != 0) throw Problem("its triangles are incomplete");
    return stream;
}

void applyFilter(const Stream& stream, uint8_t* data) {
    if (stream.filter == "NONE") return;
    const bool octahedral = stream.filter == "OCTAHEDRAL", quaternion = stream.filter == "QUATERNION",
               exponential = stream.filter == "EXPONENTIAL";
    if (!octahedral && !quaternion && !exponential)
        throw Problem(fmt::format("its filter \"{}\" is not supported", stream.filter));
    const bool fits = stream.mode == "ATTRIBUTES" &&
                      (!octahedral || stream.stride == 4 || stream.stride == 8) &&
                      (!quaternion || stream.stride == 8);
    if (!fits) throw Problem("its filter does not go with its stride");
    if (octahedral) meshopt_decodeFilterOct(data, stream.count, stream.stride);
    if (quaternion) meshopt_decodeFilterQuat(data, stream.count, stream.stride);
    if (exponential) meshopt_decodeFilterExp(data, stream.count, stream.stride);
}

std::vector<uint8_t> decoded(const Stream& stream) {
    // The low half of the first byte is the codec's version: 0 of vertices, 0 and 1 of indices.
    if (stream.mode == "ATTRIBUTES" && !stream.bytes.empty() && stream.bytes[0] > 0xa0 &&
        stream.bytes[0] <= 0xaf)
        throw Problem(
            fmt::format("its data are of version {} of the vertex codec, of which only 0 is "
                        "supported: `npx @gltf-transform/cli copy IN.glb OUT.glb` undoes it",
                        stream.bytes[0] & 15));
    std::vector<uint8_t> bytes(stream.size());
    using Decode = int (*)(void*, size_t, size_t, const unsigned char*, size_t);
    const Decode decode = stream.mode == "ATTRIBUTES"  ? Decode(meshopt_decodeVertexBuffer)
                          : stream.mode == "TRIANGLES" ? Decode(meshopt_decodeIndexBuffer)
                                                       : Decode(meshopt_decodeIndexSequence);
    if (stream.count > 0 &&
        decode(bytes.data(), stream.count, stream.stride, stream.bytes.data(), stream.bytes.size()) != 0)
        throw Problem("its compressed data are damaged");
    applyFilter(stream, bytes.data());
    return bytes;
}

}  // namespace

void decodeMeshopt(GltfSource& source, MemoryBudget& budget) {
    for (size_t i = 0; i < countOf(source.json, "bufferViews"); ++i) {
        for (const char* name : kMeshopt) {
            const json* compressed = findExtension(gltfItem(source.json, "bufferViews", i), name);
            if (!compressed) continue;
            try {
                const Stream stream = streamOf(source, *compressed);
                budget.charge(stream.size(), "the compressed bufferViews");
                source.buffers.push_back(decoded(stream));
            } catch (const std::runtime_error& error) {
                throw Problem(fmt::format("bufferViews[{}] of {}: {}", i, name, error.what()));
            }
            json& view = source.json["bufferViews"][i];
            view["buffer"] = source.buffers.size() - 1;
            view["byteLength"] = source.buffers.back().size();
            view.erase("byteOffset");
            view.erase("extensions");
        }
    }
    for (const char* name : kMeshopt) forgetExtension(source.json, name);
}

}  // namespace phat::gltf
