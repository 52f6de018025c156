#pragma once
// The journal of a bake: finished parts on disk until the baked file is complete.
//
// Header: "PHATJRNL", format version (u32), 0 (u32), fingerprint (u64). Then records, only ever appended:
// key (u64), length (u32), CRC-32 of key, length and bytes (u32), bytes. All little endian. A record that is
// cut off or damaged, and everything after it, counts as never written.

#include <memory>
#include <string>

#include "core/bake/journal.h"
#include "core/base/fingerprint.h"

namespace phat {

struct GltfSource;  // io/gltf/gltf_source.h

/// Adds the bytes of a glTF file and of all files that it names. Throws FileError. pre: its buffers are read.
void addGltf(Fingerprint& fingerprint, const GltfSource& source);
/// Adds the bytes of any file. Throws FileError.
void addFile(Fingerprint& fingerprint, const std::string& path);

/// A journal in a file. With `resume`, the records of an earlier run with the same fingerprint are kept;
/// otherwise, and when the file is of another bake, it is put aside and a new one begins.
/// Throws FileError, also from store() when the disk is full, when another process has the journal open, and
/// when something else has its name, which is not touched.
class FileJournal : public BakeJournal {
  public:
    FileJournal(const std::string& path, uint64_t fingerprint, bool resume);
    ~FileJournal() override;
    FileJournal(const FileJournal&) = delete;
    FileJournal& operator=(const FileJournal&) = delete;

    std::vector<uint8_t> load(uint64_t key) override;
    void store(uint64_t key, const std::vector<uint8_t>& bytes) override;

    /// Records that an earlier run has left.
    size_t resumedRecords() const;
    /// Where an earlier run's journal is now that was not used; "": there was none.
    const std::string& putAside() const { return putAside_; }
    /// Whether nothing is stored.
    bool empty() const;
    /// Deletes the file: the bake is done.
    void remove();

  private:
    struct State;
    std::unique_ptr<State> state_;
    std::string putAside_;
};

}  // namespace phat
