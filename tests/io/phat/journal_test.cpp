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
}

TEST_F(Journal, PutsAsideWhatItHasNoUseFor) {
    write();
    const auto earlier = readBytes(path);
    {
        FileJournal journal(path, 10, true);
        EXPECT_EQ(journal.putAside(), path + ".old");
        journal.store(1, {1});
    }
    EXPECT_EQ(readBytes(path + ".old"), earlier);
    EXPECT_EQ(FileJournal(path, 10, true).putAside(), "");  // used
    EXPECT_EQ(FileJournal(path, 10, true).resumedRecords(), 1u);
    EXPECT_EQ(FileJournal(path, 10, false).putAside(), path + ".old");
    EXPECT_NE(readBytes(path + ".old"), earlier);            // the last one is kept
    EXPECT_EQ(FileJournal(path, 10, false).putAside(), "");  // nothing was stored
}

// Of its name or of that which a journal is put aside to.
TEST_F(Journal, TouchesNothingElse) {
    const std::vector<char> text{'n', 'o', ' ', 'j', 'o', 'u', 'r', 'n', 'a', 'l'};
    writeBytes(path, text);
    for (const bool resume : {false, true}) EXPECT_THROW(FileJournal(path, 9, resume), FileError);
    EXPECT_EQ(readBytes(path), text);

    const std::string target = folder.file("target");
    writeBytes(target, text);
    ASSERT_EQ(unlink(path.c_str()), 0);
    ASSERT_EQ(symlink(target.c_str(), path.c_str()), 0);
    EXPECT_THROW(FileJournal(path, 9, false), FileError);
    EXPECT_EQ(readBytes(target), text);

    ASSERT_EQ(unlink(path.c_str()), 0);
    write();
    writeBytes(path + ".old", text);
    EXPECT_THROW(FileJournal(path, 9, false), FileError);
    EXPECT_EQ(readBytes(path + ".old"), text);
    EXPECT_EQ(FileJournal(path, 9, true).resumedRecords(), 3u);
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
