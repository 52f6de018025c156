#pragma once
// Where things are in a journal (io/phat/bake_journal.h), for the target and its mutations.

#include <cstddef>
#include <cstdint>

namespace phat::fuzz {

inline constexpr uint64_t kFingerprint = 0x1122334455667788;  // of the corpus
inline constexpr size_t kJournalHeader = 24;                  // bytes
inline constexpr size_t kRecordHeader = 16;                   // key (8), length (4), CRC-32 (4)

}  // namespace phat::fuzz
