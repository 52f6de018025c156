#pragma once

namespace phat {

/// Gives Dear ImGui the font that fontconfig has for "sans-serif", or its own bitmap font where there is
/// none. pre: a context of Dear ImGui without fonts.
void addFont(float linePixels);

}  // namespace phat
