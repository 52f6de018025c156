#include "viewer/widgets.h"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/base/atomic_file.h"

namespace phat {
namespace {

WidgetRecord* record() {
    return static_cast<WidgetRecord*>(ImGui::GetIO().UserData);
}

// After a widget that is clicked anywhere.
bool recordWhole(const std::string& label, bool result) {
    if (WidgetRecord* to = record()) to->add(label, ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    return result;
}

// Before a widget with a value: its frame is as wide as the panel says, its label stands right of it.
void recordFrame(const char* label) {
    WidgetRecord* to = record();
    if (!to) return;
    const ImVec2 low = ImGui::GetCursorScreenPos();
    to->add(label, low, {low.x + ImGui::CalcItemWidth(), low.y + ImGui::GetFrameHeight()});
}

}  // namespace

std::string widgetsFile() {
    const char* path = std::getenv("PHAT_WIDGETS");
    return path ? path : "";
}

WidgetRecord::WidgetRecord(std::string path) : path_(std::move(path)) {
    if (!path_.empty()) ImGui::GetIO().UserData = this;
}

WidgetRecord::~WidgetRecord() {
    if (!path_.empty()) ImGui::GetIO().UserData = nullptr;
}

void WidgetRecord::add(const std::string& label, ImVec2 low, ImVec2 high) {
    now_.push_back({label, {int(low.x), int(low.y), int(high.x), int(high.y)}});
}

void WidgetRecord::write() {
    if (path_.empty() || now_ == written_) return now_.clear();
    auto list = nlohmann::json::array();
    for (const Entry& entry : now_)
        list.push_back({entry.label, entry.area[0], entry.area[1], entry.area[2], entry.area[3]});
    const std::string text = list.dump();
    replaceFile(path_, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    written_ = std::exchange(now_, {});
}

namespace widgets {

bool header(const char* label, ImGuiTreeNodeFlags flags) {
    return recordWhole(label, ImGui::CollapsingHeader(label, flags));
}

bool button(const char* label) {
    return recordWhole(label, ImGui::Button(label));
}

bool smallButton(const char* label) {
    return recordWhole(label, ImGui::SmallButton(label));
}

bool checkbox(const char* label, bool* value) {
    return recordWhole(label, ImGui::Checkbox(label, value));
}

bool sliderFloat(const char* label, float* value, float least, float most, const char* format,
                 ImGuiSliderFlags flags) {
    recordFrame(label);
    return ImGui::SliderFloat(label, value, least, most, format, flags);
}

bool sliderInt(const char* label, int* value, int least, int most, ImGuiSliderFlags flags) {
    recordFrame(label);
    return ImGui::SliderInt(label, value, least, most, "%d", flags);
}

bool dragPositive(const char* label, float* value) {
    recordFrame(label);
    return ImGui::DragFloat(label, value, 0.01f * std::max(*value, 0.1f), 0, 1e6f, "%.3g");
}

bool dragVector(const char* label, float* xyz, float speed, const char* format) {
    recordFrame(label);
    return ImGui::DragFloat3(label, xyz, speed, 0, 0, format);
}

bool colorEdit(const char* label, float* rgb) {
    recordFrame(label);
    return ImGui::ColorEdit3(label, rgb, ImGuiColorEditFlags_Float);
}

bool beginList(const char* label, const char* shown) {
    recordFrame(label);
    return ImGui::BeginCombo(label, shown, ImGuiComboFlags_HeightLarge);
}

bool listItem(const char* list, const std::string& item, bool selected) {
    const bool chosen = ImGui::Selectable(item.c_str(), selected);
    if (record()) recordWhole(std::string(list) + "/" + item, chosen);
    return chosen;
}

bool list(const char* label, int* index, std::span<const char* const> names) {
    const bool known = *index >= 0 && *index < int(names.size());
    if (!beginList(label, known ? names[size_t(*index)] : "")) return false;
    bool chosen = false;
    for (int i = 0; i < int(names.size()); ++i) {
        ImGui::PushID(i);
        if (listItem(label, names[size_t(i)], i == *index)) {
            *index = i;
            chosen = true;
        }
        if (i == *index) ImGui::SetItemDefaultFocus();
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return chosen;
}

}  // namespace widgets
}  // namespace phat
