#include "io/phat/phat_payload.h"

#include <zlib.h>

#include <algorithm>
#include <stdexcept>

namespace phat {
namespace {

// Large enough that zlib's set-up is nothing, small enough that a stop request is seen within milliseconds.
constexpr size_t kPieceBytes = 256 << 10;
// No deflate stream expands further: 258 bytes from 2 bits.
constexpr size_t kMaxPayloadExpansion = 1032;

struct Deflater {
    z_stream z{};
    Deflater() {
        if (deflateInit(&z, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::runtime_error("zlib has no memory");
    }
    ~Deflater() { deflateEnd(&z); }
};

struct Inflater {
    z_stream z{};
    Inflater() {
        if (inflateInit(&z) != Z_OK) throw std::runtime_error("zlib has no memory");
    }
    ~Inflater() { inflateEnd(&z); }
};

}  // namespace

std::vector<uint8_t> encodePayload(std::span<const uint8_t> bytes, const Progress* progress) {
    std::vector<uint8_t> stream;
    std::vector<uint8_t> piece(kPieceBytes);
    Deflater deflater;
    z_stream& z = deflater.z;
    size_t begin = 0;
    int status = Z_OK;
    do {
        if (progress) progress->throwIfStopped();
        const size_t size = std::min(kPieceBytes, bytes.size() - begin);
        const bool last = begin + size == bytes.size();
        z.next_in = const_cast<uint8_t*>(bytes.data()) + begin;
        z.avail_in = uInt(size);
        do {
            z.next_out = piece.data();
            z.avail_out = uInt(piece.size());
            status = deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
            stream.insert(stream.end(), piece.data(), z.next_out);
        } while (z.avail_out == 0);
        begin += size;
    } while (status != Z_STREAM_END);
    return stream;
}

std::vector<uint8_t> decodePayload(std::span<const uint8_t> stream, size_t byteLength) {
    if (byteLength / kMaxPayloadExpansion > stream.size())
        throw std::runtime_error("a payload is too short for what it should hold");
    std::vector<uint8_t> bytes(byteLength);
    Inflater inflater;
    z_stream& z = inflater.z;
    size_t consumed = 0, produced = 0;
    uint8_t overflow;  // one byte of room past the end shows a stream that holds too much
    while (true) {
        const size_t inSize = std::min(kPieceBytes, stream.size() - consumed);
        const size_t outSize = std::min(kPieceBytes, byteLength - produced);
        z.next_in = const_cast<uint8_t*>(stream.data()) + consumed;
        z.avail_in = uInt(inSize);
        z.next_out = outSize ? bytes.data() + produced : &overflow;
        z.avail_out = outSize ? uInt(outSize) : 1;
        const uInt room = z.avail_out;
        const int status = inflate(&z, Z_NO_FLUSH);
        consumed += inSize - z.avail_in;
        const size_t written = room - z.avail_out;
        if (written > outSize) throw std::runtime_error("a payload holds more than its size says");
        produced += written;
        if (status == Z_STREAM_END) break;
        if (status != Z_OK) throw std::runtime_error("a payload is truncated or damaged");
    }
    if (produced != byteLength) throw std::runtime_error("a payload holds less than its size says");
    if (consumed != stream.size()) throw std::runtime_error("a payload has bytes after its end");
    return bytes;
}

}  // namespace phat
