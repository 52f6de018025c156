#pragma once
// Small glTF files made by the tests themselves.

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace phat::test {

enum ComponentType { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };

/// A glTF under construction: `json` is free to be changed; data go into one buffer.
struct GltfBuilder {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                           {"scene", 0},
                           {"scenes", nlohmann::json::array({nlohmann::json::object()})}};
    std::vector<char> binary;

    /// A buffer view over raw bytes.
    template <typename T>
    int view(const std::vector<T>& values, int stride = 0) {
        binary.resize((binary.size() + 3) / 4 * 4);
        nlohmann::json view = {
            {"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (stride > 0) view["byteStride"] = stride;
        const size_t offset = binary.size();
        binary.resize(offset + values.size() * sizeof(T));
        std::memcpy(binary.data() + offset, values.data(), values.size() * sizeof(T));
        return push("bufferViews", view);
    }

    int accessor(int view, int component, const char* type, size_t count, bool normalized = false,
                 int offset = 0) {
        nlohmann::json accessor = {
            {"componentType", component}, {"type", type}, {"count", count}, {"byteOffset", offset}};
        if (view >= 0) accessor["bufferView"] = view;
        if (normalized) accessor["normalized"] = true;
        return push("accessors", accessor);
    }

    /// Float accessor over its own view.
    int floats(const char* type, const std::vector<float>& values) {
        const std::string name = type;
        const size_t components = name == "SCALAR" ? 1 : size_t(name.back() - '0');
        return accessor(view(values), kFloat, type, values.size() / components);
    }

    int indices(const std::vector<uint16_t>& values) {
        return accessor(view(values), kUnsignedShort, "SCALAR", values.size());
    }

    int push(const char* section, const nlohmann::json& element) {
        json[section].push_back(element);
        return int(json[section].size() - 1);
    }

    /// A mesh of one primitive.
    int mesh(const nlohmann::json& primitive) { return push("meshes", {{"primitives", {primitive}}}); }

    /// A root node of the scene.
    int root(const nlohmann::json& node) {
        const int index = push("nodes", node);
        json["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    std::vector<char> glb() const {
        nlohmann::json complete = json;
        if (!binary.empty()) complete["buffers"] = {{{"byteLength", binary.size()}}};
        return glbOf(complete.dump(), binary);
    }

    static std::vector<char> glbOf(std::string text, std::vector<char> bytes) {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        bytes.resize((bytes.size() + 3) / 4 * 4);
        std::vector<char> file;
        const auto put = [&](size_t value) {
            for (int i = 0; i < 4; ++i) file.push_back(char(value >> (8 * i)));
        };
        put(0x46546C67);
        put(2);
        put(12 + 8 + text.size() + (bytes.empty() ? 0 : 8 + bytes.size()));
        put(text.size());
        put(0x4E4F534A);
        file.insert(file.end(), text.begin(), text.end());
        if (!bytes.empty()) {
            put(bytes.size());
            put(0x004E4942);
            file.insert(file.end(), bytes.begin(), bytes.end());
        }
        return file;
    }
};

inline std::string base64(const std::vector<char>& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

}  // namespace phat::test
