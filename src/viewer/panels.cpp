#include "viewer/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "viewer/input.h"
#include "viewer/panel_parts.h"

namespace phat {
namespace {

// Unscaled pixels: the longest label beside a usable slider.
constexpr float kPanelWidth = 330;
// Four seconds at 30 pictures a second.
constexpr int kTurntableFrames = 120;

void drawOutput(ViewerState& state, bool turning, PanelActions& actions) {
    if (!widgets::header("Output")) return;
    actions.saveImage = widgets::button("Save image (P)");
    ImGui::SameLine();
    ImGui::BeginDisabled(state.view.left == Source::phatexels);
    actions.copyCommand = widgets::button("Copy render command");
    ImGui::EndDisabled();
    ImGui::BeginDisabled(!state.document->hasBake);
    actions.save = widgets::button("Save file (Ctrl+S)");
    ImGui::SameLine();
    if (turning)
        actions.stopTurntable = widgets::button("Stop turntable");
    else if (widgets::button("Render turntable"))
        actions.turntableFrames = kTurntableFrames;
    ImGui::EndDisabled();
}

void drawKeys() {
    if (!widgets::header("Keyboard and mouse")) return;
    if (!ImGui::BeginTable("keys", 2)) return;
    for (const KeyHelp& help : kKeyHelp) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(help.keys);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(help.does);
    }
    ImGui::EndTable();
}

std::string samplesLine(const char* source, Pictures::SideReport report) {
    if (report.samples >= report.wanted) return source;
    return fmt::format("{}, {} sample{}", source, report.samples, report.samples == 1 ? "" : "s");
}

// What is being moved, at the window's upper edge, and the axis that it keeps to.
void drawGrab(const ViewerState& state, float leftEdge) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetTextLineHeight();
    const Grab& grab = *state.grab;
    const float pixel = (size.x - leftEdge) / float(state.pictureSize.x);
    if (grab.axis >= 0) {
        glm::vec3 axis(0);
        axis[grab.axis] = 0.5f * boundsOf(state.document->shown()).diagonal();
        const auto a = placeInPicture(state, grab.pivotWorld - axis);
        const auto b = placeInPicture(state, grab.pivotWorld + axis);
        const auto middle = placeInPicture(state, grab.pivotWorld);
        constexpr ImU32 kColors[] = {IM_COL32(255, 80, 80, 200), IM_COL32(80, 220, 80, 200),
                                     IM_COL32(90, 130, 255, 200)};
        list->PushClipRect({leftEdge, 0}, size);
        for (const auto& end : {a, b})
            if (end && middle)
                list->AddLine({leftEdge + middle->x * pixel, middle->y * pixel},
                              {leftEdge + end->x * pixel, end->y * pixel}, kColors[grab.axis]);
        list->PopClipRect();
    }
    const std::string words = describe(grab);
    const ImVec2 position(leftEdge + line, line);
    const float width = size.x - leftEdge - 2 * line;
    list->AddText(nullptr, 0, {position.x + 1, position.y + 1}, IM_COL32(0, 0, 0, 255), words.c_str(),
                  nullptr, width);
    list->AddText(nullptr, 0, position, IM_COL32(255, 255, 255, 255), words.c_str(), nullptr, width);
}

// Files to choose from.
void drawFiles(const ViewerState& state, PanelActions& actions) {
    if (state.fileChanged) {
        wrappedText("The file has changed on disk.");
        ImGui::SameLine();
        if (widgets::smallButton("Reload")) actions.open = state.document->path;
    }
    if (state.recentFiles.empty() || !widgets::header("Recent files")) return;
    for (const std::string& path : state.recentFiles) {
        ImGui::PushID(path.c_str());
        if (widgets::listItem("Recent files", std::filesystem::path(path).filename(), false))
            actions.open = path;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path.c_str());
        ImGui::PopID();
    }
}

// What each side shows, at the window's lower edge.
void drawLabels(const ViewerState& state, const PanelInput& input, float leftEdge) {
    const Pictures& pictures = input.pictures;
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetTextLineHeight();
    const auto label = [&](float x, const std::string& words, int row = 0) {
        const ImVec2 position(x, size.y - float(2 + row) * line);
        list->AddText({position.x + 1, position.y + 1}, IM_COL32(0, 0, 0, 255), words.c_str());
        list->AddText(position, IM_COL32(255, 255, 255, 255), words.c_str());
    };
    const auto width = [](const std::string& words) { return ImGui::CalcTextSize(words.c_str()).x; };
    std::string left = samplesLine(kSourceNames[size_t(state.view.left)], pictures.left());
    if (input.light && !input.light->converged && state.view.liveLight)
        left += fmt::format(", lighting {:.0f} % updated", 100 * overall(input.light->upToDate));
    if (!state.view.compare) {
        label(size.x - width(left) - line, left);
        return;
    }
    const std::string right = samplesLine(kSourceNames[size_t(state.view.right)], pictures.right());
    const float wipe = leftEdge + state.view.wipe * (size.x - leftEdge);
    if (!state.view.difference) list->AddLine({wipe, 0}, {wipe, size.y}, IM_COL32(255, 255, 255, 160));
    const float leftX = std::max(wipe - width(left) - line, leftEdge + line);
    const float rightX = std::min(wipe + line, size.x - width(right) - line);
    label(leftX, left);
    // Above it where the line is too near to an edge for both.
    label(rightX, right, rightX < leftX + width(left) + line ? 1 : 0);
}

// Over the picture, where it moves nothing that a hand may be about to press.
void drawMessage(const std::string& message, float leftEdge) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetTextLineHeight();
    ImGui::SetNextWindowPos({leftEdge + line, size.y - 3 * line}, ImGuiCond_Always, {0, 1});
    ImGui::Begin("message", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.7f, 0.4f, 1));
    ImGui::PushTextWrapPos(std::max(size.x - leftEdge - 4 * line, 4 * line));
    panelText(message);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
    ImGui::End();
}

}  // namespace

void panelText(const std::string& line) {
    ImGui::TextUnformatted(line.c_str());
}

void wrappedText(const std::string& line) {
    ImGui::PushTextWrapPos(0);
    panelText(line);
    ImGui::PopTextWrapPos();
}

void valueRow(const std::string& name, const std::string& value) {
    panelText(name);
    const float right = ImGui::GetWindowContentRegionMax().x;
    ImGui::SameLine(std::max(right - ImGui::CalcTextSize(value.c_str()).x, 0.0f));
    panelText(value);
}

float panelWidth(float uiScale) {
    return kPanelWidth * uiScale;
}

PanelActions drawPanels(ViewerState& state, const PanelInput& input) {
    PanelActions actions;
    const float leftEdge = state.view.panels ? panelWidth(input.uiScale) : 0.0f;
    if (state.document) drawLabels(state, input, leftEdge);
    if (state.grab) drawGrab(state, leftEdge);
    if (!state.message.empty()) drawMessage(state.message, leftEdge);
    if (!state.view.panels) return actions;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({panelWidth(input.uiScale), ImGui::GetIO().DisplaySize.y});
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings;
    ImGui::Begin("panels", nullptr, flags);
    ImGui::PushItemWidth(-ImGui::GetFontSize() * 8);
    if (!input.bakeStatus.empty()) {
        wrappedText(input.bakeStatus);
        ImGui::ProgressBar(input.bakeFraction);
    }
    drawFiles(state, actions);
    if (!state.document) {
        wrappedText("Drop a .glb, .gltf or baked .phat.glb file on this window.");
    } else {
        Edit edit{state.document->edits.now()};
        drawPicturePanel(state);
        drawSelectionPanel(state, edit);
        drawLightsPanel(state, edit);
        drawMotionPanel(state, edit);
        drawLivePanel(state, input);
        drawComparePanel(state, input.pictures);
        drawPhatexelPanel(state, input.pictures);
        drawPerformancePanel(state, input.pictures);
        drawOutput(state, input.turning, actions);
        drawKeys();
        if (edit.changed) {
            // Held sliders go on with the edit that their first motion began.
            state.document->edits.change(std::move(edit.next), state.editing);
            state.editing = true;
            state.touch();
        }
        if (!ImGui::IsAnyItemActive()) state.editing = false;
    }
    ImGui::PopItemWidth();
    ImGui::End();
    return actions;
}

}  // namespace phat
