#include <zlib.h>

#include <cstring>

#include "glb_parts.h"
#include "journal_layout.h"
#include "targets.h"

namespace phat::fuzz {
namespace {

// Checksums that are right, of records whose lengths are cut to what is there.
void sealRecords(uint8_t* data, size_t size, Rng& rng) {
    for (size_t at = kJournalHeader; at + kRecordHeader <= size;) {
        const size_t left = size - at - kRecordHeader;
        uint32_t length;
        std::memcpy(&length, data + at + 8, sizeof(length));
        if (length > left) {
            if (oneIn(rng, 4)) return;
            length = uint32_t(left);
            std::memcpy(data + at + 8, &length, sizeof(length));
        }
        uLong crc = crc32_z(0, data + at, 12);
        if (length > 0) crc = crc32_z(crc, data + at + kRecordHeader, length);
        const auto checksum = uint32_t(crc);
        std::memcpy(data + at + 12, &checksum, sizeof(checksum));
        at += kRecordHeader + length;
    }
}

}  // namespace

size_t mutateJournal(uint8_t* data, size_t size, size_t maxSize, unsigned seed) {
    Rng rng(seed);
    size = mutateBytes(data, size, maxSize, seed);
    if (size >= kJournalHeader && !oneIn(rng, 8)) {
        std::memcpy(data, "PHATJRNL\1\0\0\0\0\0\0\0", 16);
        std::memcpy(data + 16, &kFingerprint, sizeof(kFingerprint));
    }
    if (!oneIn(rng, 8)) sealRecords(data, size, rng);
    return size;
}

}  // namespace phat::fuzz
