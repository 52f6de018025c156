#include "io/gltf/gltf_container.h"

#include <fmt/core.h>

#include <array>
#include <fstream>
#include <string_view>

#include "io/gltf/gltf_problem.h"

namespace phat::gltf {
namespace {

constexpr uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t kBinaryChunk = 0x004E4942;
constexpr uint64_t kHeaderBytes = 12;
constexpr uint64_t kChunkHeaderBytes = 8;
// A description is kilobytes to megabytes; with every buffer as base64 inside, still less than this.
constexpr uint64_t kMaxJsonBytes = 1ull << 30;

uint32_t littleEndian32(const uint8_t* bytes) {
    return uint32_t(bytes[0]) | uint32_t(bytes[1]) << 8 | uint32_t(bytes[2]) << 16 | uint32_t(bytes[3]) << 24;
}

template <typename Bytes>
void readExactly(std::ifstream& file, Bytes& bytes, uint64_t size) {
    bytes.resize(size);
    file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size));
    if (uint64_t(file.gcount()) != size) throw Problem("cannot be read to its end");
}

uint64_t plainFileSize(const std::filesystem::path& path) {
    std::error_code error;
    // Devices and pipes have no size and may never end.
    if (!std::filesystem::exists(path, error)) throw Problem("no such file");
    if (!std::filesystem::is_regular_file(path, error)) throw Problem("not a plain file");
    const uint64_t size = std::filesystem::file_size(path, error);
    if (error) throw Problem("cannot be read");
    return size;
}

void readGlb(std::ifstream& file, uint64_t fileSize, Container& container) {
    std::array<uint8_t, kHeaderBytes> header;
    file.read(reinterpret_cast<char*>(header.data()), header.size());
    if (uint64_t(file.gcount()) != header.size()) throw Problem("truncated GLB header");
    const uint32_t version = littleEndian32(&header[4]);
    if (version != 2) throw Problem(fmt::format("GLB version {} is not supported, only 2", version));
    const uint64_t total = littleEndian32(&header[8]);
    if (total > fileSize) {
        throw Problem(fmt::format("truncated: the header says {} bytes, the file has {}", total, fileSize));
    }

    uint64_t position = kHeaderBytes;
    for (int chunk = 0; position + kChunkHeaderBytes <= total; ++chunk) {
        std::array<uint8_t, kChunkHeaderBytes> chunkHeader;
        file.seekg(std::streamoff(position));
        file.read(reinterpret_cast<char*>(chunkHeader.data()), chunkHeader.size());
        if (!file) throw Problem("cannot be read to its end");
        const uint64_t length = littleEndian32(&chunkHeader[0]);
        const uint32_t type = littleEndian32(&chunkHeader[4]);
        position += kChunkHeaderBytes;
        if (length > total - position) {
            throw Problem(fmt::format("GLB chunk {} of {} bytes does not fit into the file", chunk, length));
        }
        if (chunk == 0) {
            if (type != kJsonChunk) throw Problem("the first GLB chunk is not JSON");
            if (length > kMaxJsonBytes) throw Problem("the JSON chunk is too large");
            readExactly(file, container.json, length);
        } else if (chunk == 1 && type == kBinaryChunk) {
            readExactly(file, container.binary, length);
            container.hasBinary = true;
        }
        position += length;
    }
    if (container.json.empty()) throw Problem("GLB without a JSON chunk");
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percentDecoded(std::string_view uri) {
    std::string text;
    for (size_t i = 0; i < uri.size(); ++i) {
        const bool escape =
            uri[i] == '%' && i + 2 < uri.size() && hexDigit(uri[i + 1]) >= 0 && hexDigit(uri[i + 2]) >= 0;
        if (escape) {
            text += char(hexDigit(uri[i + 1]) * 16 + hexDigit(uri[i + 2]));
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

int base64Digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;  // both alphabets of RFC 4648
    if (c == '/' || c == '_') return 63;
    return -1;
}

std::vector<uint8_t> base64Decoded(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    uint32_t bits = 0;
    int bitCount = 0;
    for (const char c : text) {
        const int digit = base64Digit(c);
        if (digit < 0) throw Problem("a data URI is not valid base64");
        bits = bits << 6 | uint32_t(digit);
        bitCount += 6;
        if (bitCount >= 8) {
            bitCount -= 8;
            bytes.push_back(uint8_t(bits >> bitCount));
        }
    }
    return bytes;
}

std::vector<uint8_t> readDataUri(std::string_view uri) {
    const size_t comma = uri.find(',');
    if (comma == std::string_view::npos) throw Problem("a data URI has no data");
    const std::string_view type = uri.substr(0, comma);
    const std::string_view payload = uri.substr(comma + 1);
    if (type.ends_with(";base64")) return base64Decoded(payload);
    const std::string text = percentDecoded(payload);
    return {text.begin(), text.end()};
}

// RFC 3986: a scheme is letters, digits, "+", "-", "." before the first colon.
bool hasScheme(std::string_view uri) {
    const size_t end = uri.find_first_of(":/?#");
    return end != std::string_view::npos && uri[end] == ':';
}

bool isInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
    const auto relative = path.lexically_relative(folder);
    return !relative.empty() && *relative.begin() != ".." && !relative.is_absolute();
}

}  // namespace

Container readContainer(const std::string& path) {
    const uint64_t size = plainFileSize(path);
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Problem("cannot be opened");

    std::array<uint8_t, 4> magic{};
    file.read(reinterpret_cast<char*>(magic.data()), magic.size());
    if (size < magic.size()) throw Problem("too short to be glTF");
    file.seekg(0);

    Container container;
    if (littleEndian32(magic.data()) == kMagic) {
        container.isGlb = true;
        readGlb(file, size, container);
        return container;
    }
    if (size > kMaxJsonBytes) throw Problem("neither a GLB container nor glTF JSON");
    readExactly(file, container.json, size);
    const size_t first = container.json.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first == std::string::npos || container.json[first] != '{') {
        throw Problem("neither a GLB container nor glTF JSON");
    }
    return container;
}

std::vector<uint8_t> readUri(const std::string& uri, const std::filesystem::path& folder, uint64_t maxBytes) {
    if (uri.starts_with("data:")) return readDataUri(uri);
    if (hasScheme(uri))
        throw Problem(fmt::format("URI \"{}\" is not a file beside the scene", shortUri(uri)));

    const std::string name = percentDecoded(uri);
    const std::filesystem::path relative(name);
    bool leaves = name.empty() || relative.is_absolute() || name.find('\\') != std::string::npos ||
                  name.find('\0') != std::string::npos;
    for (const auto& part : relative) leaves = leaves || part == "..";
    std::error_code error;
    const auto root = std::filesystem::canonical(folder, error);
    if (error) throw Problem("the scene's folder cannot be read");
    if (!leaves) {
        const auto target = std::filesystem::weakly_canonical(root / relative, error);
        leaves = error || !isInside(target, root);
    }
    if (leaves) throw Problem(fmt::format("URI \"{}\" leads outside the scene's folder", shortUri(uri)));

    try {
        const uint64_t size = std::min(plainFileSize(root / relative), maxBytes);
        std::ifstream file(root / relative, std::ios::binary);
        if (!file) throw Problem("cannot be opened");
        std::vector<uint8_t> bytes;
        readExactly(file, bytes, size);
        return bytes;
    } catch (const Problem& problem) {
        throw Problem(fmt::format("\"{}\": {}", shortUri(uri), problem.what()));
    }
}

std::string shortUri(const std::string& uri) {
    constexpr size_t kShown = 80;
    if (uri.starts_with("data:")) return uri.substr(0, std::min(uri.find_first_of(";,"), kShown));
    return uri.size() <= kShown ? uri : uri.substr(0, kShown) + "...";
}

}  // namespace phat::gltf
