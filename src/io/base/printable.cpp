#include "io/base/printable.h"

namespace phat {
namespace {

bool isControl(unsigned char c) {
    return c < 0x20 || c == 0x7f;
}

// U+0080 to U+009F, which a terminal may obey as it obeys ESC and a letter: 0xC2 and one of these in UTF-8.
bool isSecondOfControl(unsigned char c) {
    return c >= 0x80 && c < 0xa0;
}

}  // namespace

std::string printable(std::string text, size_t most) {
    if (text.size() > most) text = text.substr(0, most) + "...";
    for (size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (isControl(c)) text[i] = '?';
        if (c == 0xc2 && i + 1 < text.size() && isSecondOfControl(static_cast<unsigned char>(text[i + 1])))
            text.replace(i, 2, "?");
    }
    return text;
}

}  // namespace phat
