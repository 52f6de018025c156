#pragma once
// The folder of a page, in which only files that `phat web` wrote are ever replaced or removed.

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace phat {

struct SiteFile {
    std::string name;
    std::span<const uint8_t> bytes;
};

class SiteFolder {
  public:
    /// Makes the folder if it is missing. `input`: what the page is made of; `names`: files whose names do
    /// not follow from their content. Throws FileError, before anything is written, unless the folder is
    /// empty or one that `phat web` wrote, without `input` among its own files and with no file of somebody
    /// else's that is named so.
    SiteFolder(const std::string& path, const std::string& input, const std::set<std::string>& names);

    /// Writes the page's files in this order, and removes what an older page left. Throws FileError.
    void write(const std::vector<SiteFile>& files);

    std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    void checkOwn(const std::string& input) const;
    void writeList(const std::set<std::string>& names) const;

    std::string path_;
    std::set<std::string> old_;
};

}  // namespace phat
