#include <gtest/gtest.h>
#include <unistd.h>

#include "io/base/file_error.h"
#include "io/phat/bake_journal.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using Bytes = std::vector<uint8_t>;

struct Journal : testing::Test {
    TemporaryFolder folder;
    std::string path = folder.file("out.journal");

    // Three records under fingerprint 9.
    void write() {
        FileJournal journal(path, 9, false);
        journal.store(1, {1, 2, 3});
        journal.store(2, {});
        journal.store(3, Bytes(1000, 7));
    }
};

TEST_F(Journal, ReturnsWhatAnEarlierRunStored) {
    write();
    FileJournal journal(path, 9, true);
    EXPECT_EQ(journal.resumedRecords(), 3u);
    EXPECT_EQ(journal.load(1), (Bytes{1, 2, 3}));
    EXPECT_EQ(journal.load(2), Bytes());
    EXPECT_EQ(journal.load(3), Bytes(1000, 7));
    EXPECT_EQ(journal.load(4), Bytes());
    journal.store(4, {5});
    EXPECT_EQ(journal.load(4), Bytes{5});
}

TEST_F(Journal, StartsAnewWithoutResumeOrForAnotherBake) {
    write();
    EXPECT_TRUE(FileJournal(path, 10, true).empty());
    write();
    EXPECT_TRUE(FileJournal(path, 9, false).empty());
    writeBytes(path, {'n', 'o', ' ', 'j', 'o', 'u', 'r', 'n', 'a', 'l'});
    EXPECT_TRUE(FileJournal(path, 9, true).empty());
}

TEST_F(Journal, KeepsWhatIsBeforeACut) {
    write();
    const auto whole = readBytes(path);
    for (size_t length = whole.size(); length-- > 0;) {
        writeBytes(path, {whole.begin(), whole.begin() + std::ptrdiff_t(length)});
        {
            FileJournal journal(path, 9, true);
            const size_t kept = journal.resumedRecords();
            // Header 24, records 16 + 3, 16 + 0, 16 + 1000.
            EXPECT_EQ(kept, length >= 59 ? 2u : length >= 43 ? 1u : 0u) << length;
            if (kept > 0) {
                EXPECT_EQ(journal.load(1), (Bytes{1, 2, 3}));
            }
            journal.store(8, {8});
        }
        EXPECT_EQ(FileJournal(path, 9, true).load(8), Bytes{8});
    }
}

TEST_F(Journal, DropsADamagedRecordAndWhatFollows) {
    write();
    auto bytes = readBytes(path);
    bytes[24 + 16 + 1] ^= 1;  // inside the first record's bytes
    writeBytes(path, bytes);
    EXPECT_TRUE(FileJournal(path, 9, true).empty());
}

TEST_F(Journal, IsForOneProcessAtATimeAndGoneWhenRemoved) {
    FileJournal journal(path, 9, false);
    EXPECT_THROW(FileJournal(path, 9, true), FileError);
    journal.remove();
    EXPECT_NE(access(path.c_str(), F_OK), 0);
    EXPECT_THROW(FileJournal(folder.file("missing/out.journal"), 9, false), FileError);
}

TEST(Fingerprint, TellsOrderAndPiecesApart) {
    const auto of = [](const std::vector<std::string>& pieces) {
        Fingerprint fingerprint;
        for (const std::string& piece : pieces) fingerprint.add(piece);
        return fingerprint.value();
    };
    EXPECT_EQ(of({"ab", "c"}), of({"ab", "c"}));
    EXPECT_NE(of({"ab", "c"}), of({"a", "bc"}));
    EXPECT_NE(of({"ab", "c"}), of({"c", "ab"}));
    EXPECT_NE(of({std::string(8, '\0')}), of({std::string(16, '\0')}));
}

}  // namespace
}  // namespace phat
