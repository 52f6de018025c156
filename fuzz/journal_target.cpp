#include <cstring>
#include <set>

#include "expect.h"
#include "io/base/file_error.h"
#include "io/phat/bake_journal.h"
#include "journal_layout.h"
#include "scratch_file.h"
#include "targets.h"

namespace phat::fuzz {

void journal(Bytes bytes) {
    const ScratchFile file(bytes, "room.phat.glb.journal");
    try {
        FileJournal journal(file.path(), kFingerprint, /*resume=*/true);
        expect(journal.empty() == (journal.resumedRecords() == 0), "records that are counted");
        std::set<uint64_t> found;
        for (size_t at = kJournalHeader; at + kRecordHeader <= bytes.size(); ++at) {
            uint64_t key;
            std::memcpy(&key, &bytes[at], sizeof(key));
            if (!journal.load(key).empty()) found.insert(key);
        }
        expect(found.size() <= journal.resumedRecords(), "no more records than were taken over");
        journal.store(1, {1, 2, 3});
        expect(journal.load(1) == std::vector<uint8_t>{1, 2, 3}, "what was stored");
    } catch (const FileError&) {
    }
}

}  // namespace phat::fuzz
