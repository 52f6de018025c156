#include "viewer/font.h"

#include <imgui.h>

#include <memory>
#include <string>

#ifdef PHAT_FONTCONFIG
#include <fontconfig/fontconfig.h>
#endif

namespace phat {
namespace {

struct FontFile {
    std::string path;  // empty: there is none
    int index = 0;     // of a collection's fonts
};

#ifdef PHAT_FONTCONFIG

template <auto destroy>
struct Destroyer {
    void operator()(auto* object) const { destroy(object); }
};

// The outlines that Dear ImGui reads.
bool isReadable(FcPattern* font) {
    FcChar8* format = nullptr;
    if (FcPatternGetString(font, FC_FONTFORMAT, 0, &format) != FcResultMatch) return false;
    const std::string name(reinterpret_cast<const char*>(format));
    return name == "TrueType" || name == "CFF";
}

FontFile sansSerif() {
    const std::unique_ptr<FcConfig, Destroyer<FcConfigDestroy>> config(FcInitLoadConfigAndFonts());
    const std::unique_ptr<FcPattern, Destroyer<FcPatternDestroy>> wanted(FcPatternCreate());
    if (!config || !wanted) return {};
    FcPatternAddString(wanted.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>("sans-serif"));
    FcConfigSubstitute(config.get(), wanted.get(), FcMatchPattern);
    FcDefaultSubstitute(wanted.get());
    FcResult result = FcResultNoMatch;
    const std::unique_ptr<FcFontSet, Destroyer<FcFontSetDestroy>> fonts(
        FcFontSort(config.get(), wanted.get(), FcFalse, nullptr, &result));
    for (int i = 0; fonts && i < fonts->nfont; ++i) {
        FcPattern* font = fonts->fonts[i];
        FcChar8* path = nullptr;
        if (!isReadable(font) || FcPatternGetString(font, FC_FILE, 0, &path) != FcResultMatch) continue;
        FontFile file{reinterpret_cast<const char*>(path), 0};
        FcPatternGetInteger(font, FC_INDEX, 0, &file.index);
        file.index &= 0xffff;  // the upper bits name an instance of a variable font
        return file;
    }
    return {};
}

#else

FontFile sansSerif() {
    return {};
}

#endif

}  // namespace

void addFont(float linePixels) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    const FontFile file = sansSerif();
    ImFontConfig config;
    config.FontNo = file.index;
    if (!file.path.empty() && fonts.AddFontFromFileTTF(file.path.c_str(), linePixels, &config)) return;
    config.FontNo = 0;
    config.SizePixels = linePixels;
    fonts.AddFontDefault(&config);
}

}  // namespace phat
