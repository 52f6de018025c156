#pragma once
// The widgets of the panels: those of Dear ImGui, each recorded under its label, so that a program that
// drives the window finds them by name.

#include <imgui.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace phat {

/// Where the widgets of the last frame are. Writes them to a file as JSON whenever they change: an array of
/// [label, left, top, right, bottom] in pixels of the window, in the order in which they are drawn. Of what
/// holds a value that is the part to click; the label beside it is left out. An item of an open list is
/// called LIST/ITEM.
class WidgetRecord {
  public:
    /// `path` empty: nothing is recorded. pre: a context of Dear ImGui, which outlives this.
    explicit WidgetRecord(std::string path);
    ~WidgetRecord();
    WidgetRecord(const WidgetRecord&) = delete;
    WidgetRecord& operator=(const WidgetRecord&) = delete;

    void add(const std::string& label, ImVec2 low, ImVec2 high);
    /// Ends the frame. Throws FileError.
    void write();

  private:
    struct Entry {
        std::string label;
        std::array<int, 4> area{};  // left, top, right, bottom
        bool operator==(const Entry&) const = default;
    };
    std::string path_;
    std::vector<Entry> now_, written_;
};

/// Where a program that drives the window, such as a test, wants it; empty: nowhere.
std::string widgetsFile();

namespace widgets {

/// Whether the section is open.
bool header(const char* label, ImGuiTreeNodeFlags flags = 0);
bool button(const char* label);
bool smallButton(const char* label);
bool checkbox(const char* label, bool* value);
bool sliderFloat(const char* label, float* value, float least, float most, const char* format,
                 ImGuiSliderFlags flags = 0);
bool sliderInt(const char* label, int* value, int least, int most, ImGuiSliderFlags flags = 0);
/// Not below 0; a pixel of motion changes it by a hundredth.
bool dragPositive(const char* label, float* value);
bool dragVector(const char* label, float* xyz, float speed, const char* format);
bool colorEdit(const char* label, float* rgb);

/// As ImGui::BeginCombo: when true, items follow, then ImGui::EndCombo.
bool beginList(const char* label, const char* shown);
bool listItem(const char* list, const std::string& item, bool selected);
/// A list of names; whether one was chosen.
bool list(const char* label, int* index, std::span<const char* const> names);

}  // namespace widgets
}  // namespace phat
