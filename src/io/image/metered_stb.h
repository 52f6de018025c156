#pragma once
// stb_image with a limit on memory: it inflates whatever a PNG holds, however small the picture that it
// announces.

#include <cstdint>

// Of this program alone: libraries that use stb_image, too, keep theirs.
#pragma GCC visibility push(hidden)
#include <stb_image.h>
#pragma GCC visibility pop

namespace phat {

/// From here on the calls of stb_image on this thread may hold so many bytes together; what needs more fails
/// as if there were no memory. Before the first call of this function nothing can be decoded.
void allowDecoding(uint64_t bytes);

/// Enough to read a header.
inline constexpr uint64_t kHeaderAllowance = 1 << 20;

struct EncodedPicture {
    uint64_t texels = 0;
    uint64_t channels = 0;
    bool wide = false;  // 16 bits a channel
    bool jpeg = false;  // else PNG
    uint64_t fileBytes = 0;
};

/// What stb_image holds at its worst moment for such a picture.
uint64_t decodingBytes(const EncodedPicture& picture);

}  // namespace phat
