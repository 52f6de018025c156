#pragma once
// A folder of output, in which only files that the command wrote are ever replaced or removed.

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace phat {

struct OutputFile {
    std::string name;
    std::span<const uint8_t> bytes;
};

/// Whose a folder is.
struct FolderOwner {
    const char* command;  // that writes it
    const char* list;     // the file in it that lists the others
    const char* content;  // what lies in it, in messages
};
inline constexpr FolderOwner kPageFolder{"phat web", "phat-web.txt", "page"};
inline constexpr FolderOwner kLightmapFolder{"phat export", "phat-lightmap.txt", "lightmap"};

class OwnedFolder {
  public:
    /// Makes the folder if it is missing. `input`: what the output is made of; `names`: files whose names do
    /// not follow from their content. Throws FileError, before anything is written, unless the folder is
    /// empty or the owner's, without `input` among its own files and with no file of somebody else's that is
    /// named so.
    OwnedFolder(const FolderOwner& owner, const std::string& path, const std::string& input,
                const std::set<std::string>& names);

    /// Writes the files in this order, and removes what an older output left. Throws FileError.
    void write(const std::vector<OutputFile>& files);

    std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::set<std::string> readList() const;
    void checkOwn(const std::string& input) const;
    void writeList(const std::set<std::string>& names) const;

    FolderOwner owner_;
    std::string path_;
    std::set<std::string> old_;
};

}  // namespace phat
