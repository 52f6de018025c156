#include "io/gltf/gltf_container.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string_view>

#include "io/base/plain_file.h"
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
    if (const std::string reason = whyNoPlainFile(path); !reason.empty()) throw Problem(reason);
    std::error_code error;
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

bool isSpace(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f';
}

std::vector<uint8_t> base64Decoded(std::string_view text) {
    std::vector<uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    uint32_t bits = 0;
    int bitCount = 0;
    bool ended = false;
    for (const char c : text) {
        if (isSpace(c)) continue;
        ended = ended || c == '=';
        if (c == '=') continue;
        const int digit = base64Digit(c);
        if (digit < 0 || ended) throw Problem("a data URI is not valid base64");
        bits = bits << 6 | uint32_t(digit);
        bitCount += 6;
        if (bitCount >= 8) {
            bitCount -= 8;
            bytes.push_back(uint8_t(bits >> bitCount));
        }
    }
    return bytes;
}

std::string lowerCase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return lower;
}

// RFC 2397. Scheme and "base64" are of any case; the payload may be percent-encoded and broken into lines.
std::vector<uint8_t> readDataUri(std::string_view uri) {
    const size_t comma = uri.find(',');
    if (comma == std::string_view::npos) throw Problem("a data URI has no data");
    std::string type = lowerCase(uri.substr(0, comma));
    while (!type.empty() && isSpace(type.back())) type.pop_back();
    const std::string_view payload = uri.substr(comma + 1);
    const bool base64 = type.ends_with(";base64") || type.ends_with("; base64");
    if (base64 && payload.find('%') == std::string_view::npos) return base64Decoded(payload);
    const std::string text = percentDecoded(payload);
    if (base64) return base64Decoded(text);
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

// The place of a relative path inside `root`; none where it leads outside.
std::optional<std::filesystem::path> placeInside(std::string name, const std::filesystem::path& root) {
    if (name.empty() || name.find('\0') != std::string::npos) return std::nullopt;
    std::replace(name.begin(), name.end(), '\\', '/');  // as programs of Windows write
    const std::filesystem::path relative(name);
    if (relative.is_absolute()) return std::nullopt;
    const std::filesystem::path normal = (root / relative).lexically_normal();
    std::error_code error;
    const auto target = std::filesystem::weakly_canonical(normal, error);
    if (error || !isInside(normal, root) || !isInside(target, root)) return std::nullopt;
    return normal;
}

// The file in the same folder whose name differs in the case of letters alone, as where the scene was made it
// may have made no difference; `path` itself where there is none, or more than one.
std::filesystem::path withOtherCase(const std::filesystem::path& path) {
    std::error_code error;
    const std::string wanted = lowerCase(path.filename().string());
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(path.parent_path(), error))
        if (lowerCase(entry.path().filename().string()) == wanted) found.push_back(entry.path());
    return found.size() == 1 ? found[0] : path;
}

// The file that a URI means: percent-encoded as the specification asks, or, as many programs write, its plain
// name. A file that has the name is taken before a part of it counts as a query or a fragment.
std::filesystem::path fileOf(const std::string& uri, const std::filesystem::path& root) {
    const auto leads = [&] {
        return Problem(fmt::format("URI \"{}\" leads outside the scene's folder", shortUri(uri)));
    };
    const auto meant = placeInside(percentDecoded(uri), root);
    if (!meant) throw leads();
    const std::string path = uri.substr(0, uri.find_first_of("?#"));
    std::error_code error;
    if (std::filesystem::exists(*meant, error)) return *meant;
    for (const std::string& other : {uri, percentDecoded(path)})
        if (const auto place = placeInside(other, root); place && std::filesystem::exists(*place, error))
            return *place;
    const std::filesystem::path sameLetters = withOtherCase(*meant);
    const auto inside = placeInside(sameLetters.lexically_relative(root).string(), root);
    if (!inside) throw leads();
    return *inside;
}

}  // namespace

bool isDataUri(std::string_view uri) {
    return lowerCase(uri.substr(0, 5)) == "data:";
}

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
    if (isDataUri(uri)) return readDataUri(uri);
    if (hasScheme(uri))
        throw Problem(fmt::format("URI \"{}\" is not a file beside the scene", shortUri(uri)));

    std::error_code error;
    const auto root = std::filesystem::canonical(folder, error);
    if (error) throw Problem("the scene's folder cannot be read");
    const std::filesystem::path file = fileOf(uri, root);
    try {
        const uint64_t size = std::min(plainFileSize(file), maxBytes);
        std::ifstream stream(file, std::ios::binary);
        if (!stream) throw Problem("cannot be opened");
        std::vector<uint8_t> bytes;
        readExactly(stream, bytes, size);
        return bytes;
    } catch (const Problem& problem) {
        throw Problem(fmt::format("\"{}\": {}", shortUri(uri), problem.what()));
    }
}

std::string shortUri(const std::string& uri) {
    constexpr size_t kShown = 80;
    if (isDataUri(uri)) return uri.substr(0, std::min(uri.find_first_of(";,"), kShown));
    return uri.size() <= kShown ? uri : uri.substr(0, kShown) + "...";
}

}  // namespace phat::gltf
