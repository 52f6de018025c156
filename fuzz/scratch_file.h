#pragma once
// Bytes as a file, since the readers take paths.

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace phat::fuzz {

/// A file of these bytes in a folder of its own, removed with whatever is put beside it.
class ScratchFile {
  public:
    ScratchFile(std::span<const uint8_t> bytes, const std::string& name) {
        std::string folder = (std::filesystem::temp_directory_path() / "phat-fuzz-XXXXXX").string();
        if (!mkdtemp(folder.data())) throw std::runtime_error("no temporary folder");
        folder_ = folder;
        path_ = folder_ / name;
        std::ofstream file(path_, std::ios::binary);
        file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    }
    ~ScratchFile() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path folder_, path_;
};

}  // namespace phat::fuzz
