#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <fmt/format.h>

#include <map>
#include <memory>

#include "io/gltf/gltf_json.h"
#include "io/gltf/gltf_plain.h"

namespace phat::gltf {
namespace {

using nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";

// What a decoder has charged, for as long as its mesh lives.
class HeldCharge {
  public:
    explicit HeldCharge(MemoryBudget& budget) : budget_(budget) {}
    ~HeldCharge() { budget_.release(bytes_); }
    HeldCharge(const HeldCharge&) = delete;
    HeldCharge& operator=(const HeldCharge&) = delete;

    void add(uint64_t bytes) {
        budget_.charge(bytes, "its Draco data");
        bytes_ += bytes;
    }

  private:
    MemoryBudget& budget_;
    uint64_t bytes_ = 0;
};

// A decoder of `Base` that charges what the data claim before it takes that much. The counts stand before the
// connectivity; the attributes' formats are known before their values are decoded.
template <class Base>
class MeteredDecoder : public Base {
  public:
    explicit MeteredDecoder(HeldCharge& charge) : charge_(charge) {}

  protected:
    bool DecodeConnectivity() override {
        // Edgebreaker: encoded vertices, then faces; sequential: faces, then points (Draco bitstream
        // specification, sections 5.2 and 6.1).
        draco::DecoderBuffer peeked = *this->buffer();
        uint32_t first = 0, second = 0;
        if (!draco::DecodeVarint(&first, &peeked) || !draco::DecodeVarint(&second, &peeked)) return false;
        // Corner tables with what walks them: measured on draco 1.5.5, 100 to 140 bytes a face. A face has
        // three corners, and seams may make each of them a point.
        constexpr uint64_t kFaceBytes = 160, kPointBytes = 16;
        charge_.add(uint64_t(first) * kFaceBytes);
        charge_.add(uint64_t(second) *
                    (std::is_same_v<Base, draco::MeshSequentialDecoder> ? kPointBytes : kFaceBytes));
        return Base::DecodeConnectivity();
    }

    bool DecodeAllAttributes() override {
        // The values, the same as 32-bit integers, predictions of them, and the points' indices.
        uint64_t bytesPerPoint = 0;
        for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
            const draco::PointAttribute& attribute = *this->point_cloud()->attribute(i);
            bytesPerPoint += uint64_t(attribute.byte_stride()) + 8 * uint64_t(attribute.num_components()) + 8;
        }
        charge_.add(uint64_t(this->point_cloud()->num_points()) * bytesPerPoint);
        return Base::DecodeAllAttributes();
    }

  private:
    HeldCharge& charge_;
};

template <class Base>
std::unique_ptr<draco::Mesh> decodeWith(draco::DecoderBuffer& buffer, HeldCharge& charge) {
    auto mesh = std::make_unique<draco::Mesh>();
    const draco::DecoderOptions options;
    MeteredDecoder<Base> decoder(charge);
    const draco::Status status = decoder.Decode(options, &buffer, mesh.get());
    if (!status.ok()) throw Problem("its Draco data are damaged");
    return mesh;
}

std::unique_ptr<draco::Mesh> decodeMesh(std::span<const uint8_t> bytes, HeldCharge& charge) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::DecoderBuffer peeked = buffer;
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&peeked, &header).ok() ||
        header.encoder_type != draco::TRIANGULAR_MESH)
        throw Problem("its Draco data are no mesh");
    if (header.version_major != 2 || header.version_minor != 2)
        throw Problem(fmt::format("its Draco data are of version {}.{}, where glTF has 2.2",
                                  header.version_major, header.version_minor));
    return header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING
               ? decodeWith<draco::MeshEdgebreakerDecoder>(buffer, charge)
               : decodeWith<draco::MeshSequentialDecoder>(buffer, charge);
}

template <class T>
std::vector<uint8_t> valuesOf(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                              uint32_t components, uint32_t stride) {
    std::vector<uint8_t> bytes(size_t(mesh.num_points()) * stride);
    std::vector<T> value(components);
    for (uint32_t i = 0; i < mesh.num_points(); ++i) {
        const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(i));
        if (index.value() >= attribute.size() ||
            !attribute.ConvertValue<T>(index, int8_t(components), value.data()))
            throw Problem("its Draco data are damaged");
        std::memcpy(&bytes[size_t(i) * stride], value.data(), components * sizeof(T));
    }
    return bytes;
}

uint32_t dracoComponents(const json& accessor) {
    const std::string type = accessor.value("type", "");
    if (type == "SCALAR") return 1;
    if (type.size() == 4 && type.starts_with("VEC") && type[3] >= '2' && type[3] <= '4')
        return uint32_t(type[3] - '0');
    throw Problem(fmt::format("a compressed attribute of type \"{}\"", type.substr(0, 20)));
}

size_t addAttribute(GltfSource& source, const draco::Mesh& mesh, uint64_t accessorIndex, uint64_t id,
                    MemoryBudget& budget) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(uint32_t(id));
    if (!attribute) throw Problem(fmt::format("its Draco data have no attribute {}", id));
    json accessor = gltfItem(source.json, "accessors", accessorIndex);
    const uint32_t components = dracoComponents(accessor);
    const uint64_t type = wholeNumber(accessor, "componentType");
    const uint32_t size = type == kByte || type == kUnsignedByte     ? 1
                          : type == kShort || type == kUnsignedShort ? 2
                                                                     : 4;
    const uint32_t stride = (components * size + 3) / 4 * 4;  // vertex attributes are aligned to 4 bytes
    budget.charge(uint64_t(mesh.num_points()) * stride, "its Draco data");
    const auto values = [&]<class T>(T) { return valuesOf<T>(mesh, *attribute, components, stride); };
    std::vector<uint8_t> bytes;
    switch (type) {
        case kByte:
            bytes = values(int8_t());
            break;
        case kUnsignedByte:
            bytes = values(uint8_t());
            break;
        case kShort:
            bytes = values(int16_t());
            break;
        case kUnsignedShort:
            bytes = values(uint16_t());
            break;
        case kUnsignedInt:
            bytes = values(uint32_t());
            break;
        case kFloat:
            bytes = values(float());
            break;
        default:
            throw Problem(fmt::format("component type {} does not exist", type));
    }
    for (const char* key : {"byteOffset", "sparse"}) accessor.erase(key);
    accessor["count"] = mesh.num_points();
    return addAccessor(source, std::move(accessor), std::move(bytes), stride);
}

size_t addIndices(GltfSource& source, const draco::Mesh& mesh, MemoryBudget& budget) {
    budget.charge(uint64_t(mesh.num_faces()) * 12, "its Draco data");
    std::vector<uint8_t> bytes(size_t(mesh.num_faces()) * 12);
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
        for (size_t corner = 0; corner < 3; ++corner) {
            const uint32_t vertex = face[corner].value();
            std::memcpy(&bytes[f * 12 + corner * 4], &vertex, 4);
        }
    }
    return addAccessor(source,
                       {{"componentType", kUnsignedInt}, {"type", "SCALAR"}, {"count", mesh.num_faces() * 3}},
                       std::move(bytes));
}

// The attributes and indices that a primitive has once its data are decoded.
json decodedParts(GltfSource& source, const json& primitive, const json& compressed, MemoryBudget& budget) {
    HeldCharge charge(budget);
    const auto mesh = decodeMesh(bufferViewBytes(source, wholeNumber(compressed, "bufferView")), charge);
    if (mesh->num_points() == 0 || mesh->num_faces() == 0) throw Problem("its Draco data are empty");
    json parts = {{"attributes", primitive.at("attributes")}};
    for (const auto& [name, id] : compressed.at("attributes").items())
        if (parts["attributes"].contains(name))
            parts["attributes"][name] =
                addAttribute(source, *mesh, wholeNumber(primitive["attributes"], name.c_str()),
                             wholeNumber(compressed["attributes"], name.c_str()), budget);
    parts["indices"] = addIndices(source, *mesh, budget);
    return parts;
}

}  // namespace

void decodeDraco(GltfSource& source, MemoryBudget& budget) {
    std::map<std::string, json> decoded;  // primitives may share data
    for (size_t m = 0; m < countOf(source.json, "meshes"); ++m) {
        const size_t count = countOf(gltfItem(source.json, "meshes", m), "primitives");
        for (size_t p = 0; p < count; ++p) {
            const json primitive = source.json["meshes"][m]["primitives"][p];
            const json* compressed = primitive.is_object() ? findExtension(primitive, kDraco) : nullptr;
            if (!compressed) continue;
            json& parts = decoded[compressed->dump() + primitive.value("attributes", json()).dump()];
            try {
                if (parts.is_null()) parts = decodedParts(source, primitive, *compressed, budget);
            } catch (const std::runtime_error& error) {
                throw Problem(fmt::format("mesh {}: {}", m, error.what()));
            }
            json& plain = source.json["meshes"][m]["primitives"][p];
            plain.update(parts);
            plain.erase("mode");  // what was a strip is a list now
            eraseExtension(plain, kDraco);
        }
    }
    forgetExtension(source.json, kDraco);
}

}  // namespace phat::gltf
