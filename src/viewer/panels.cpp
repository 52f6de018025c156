#include "viewer/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "viewer/input.h"

namespace phat {
namespace {

// Unscaled pixels: the longest label beside a usable slider.
constexpr float kPanelWidth = 330;
// Four seconds at 30 pictures a second.
constexpr int kTurntableFrames = 120;

void text(const std::string& line) {
    ImGui::TextUnformatted(line.c_str());
}

void wrapped(const std::string& line) {
    ImGui::PushTextWrapPos(0);
    text(line);
    ImGui::PopTextWrapPos();
}

template <class Enum, size_t n>
bool choose(const char* label, Enum& value, const std::array<const char*, n>& names) {
    int index = int(value);
    if (!ImGui::Combo(label, &index, names.data(), int(n))) return false;
    value = Enum(index);
    return true;
}

void drawCameras(ViewerState& state) {
    const auto& cameras = state.document->scene().cameras;
    const char* shown = state.camera < 0  ? "moved by hand"
                        : cameras.empty() ? "overview"
                                          : cameras[size_t(state.camera)].name.c_str();
    if (!ImGui::BeginCombo("Camera", shown)) return;
    for (size_t i = 0; i < std::max<size_t>(cameras.size(), 1); ++i) {
        ImGui::PushID(int(i));
        if (ImGui::Selectable(cameras.empty() ? "overview" : cameras[i].name.c_str(), state.camera == int(i)))
            showCamera(state, int(i));
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void drawPicture(ViewerState& state) {
    if (!ImGui::CollapsingHeader("Picture", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings& view = state.view;
    drawCameras(state);
    bool changed = choose("Method", view.left, kSourceNames);
    constexpr std::array<const char*, 5> kComponents = {"all", "direct", "indirect", "glossy indirect",
                                                        "diffuse indirect"};
    changed |= choose("Light", view.component, kComponents);
    // Tone and exposure are applied on the way to the window.
    ImGui::SliderFloat("Exposure", &view.exposureStops, -8, 8, "%.1f stops");
    constexpr std::array<const char*, 3> kToneMaps = {"linear", "AgX", "ACES"};
    choose("Tone map", view.toneMap, kToneMaps);
    if (changed) state.touch();
}

void drawCompare(ViewerState& state, const Pictures& pictures) {
    ImGui::SetNextItemOpen(state.view.compare, ImGuiCond_Appearing);
    if (!ImGui::CollapsingHeader("Compare")) return;
    ViewSettings& view = state.view;
    bool changed = ImGui::Checkbox("Split the window", &view.compare);
    changed |= choose("Right", view.right, kSourceNames);
    ImGui::SliderFloat("Wipe", &view.wipe, 0, 1, "%.2f");
    ImGui::Checkbox("Show the difference", &view.difference);
    if (changed) state.touch();
    if (!view.compare) return;
    if (const auto metrics = pictures.metrics()) {
        text(fmt::format("MAE/mean {:.4f}   bias {:+.2f} %", metrics->maeOverMean, 100 * metrics->bias));
        text(fmt::format("relMSE   {:.4f}   FLIP {:.4f}", metrics->relMse, metrics->flip));
    } else {
        text("measuring ...");
    }
}

// The edit goes on while a slider is held.
struct Edit {
    SceneEdits next;
    bool changed = false;
    void note(bool now) { changed |= now; }
};

void drawMaterial(Edit& edit, Material& m) {
    edit.note(ImGui::SliderFloat("Roughness", &m.roughness, 0, 1));
    edit.note(ImGui::SliderFloat("Metallic", &m.metallic, 0, 1));
    edit.note(ImGui::ColorEdit3("Base colour", &m.baseColor.x, ImGuiColorEditFlags_Float));
    edit.note(ImGui::SliderFloat("Specular", &m.specular, 0, 1));
    if (m.normalTexture.image >= 0) edit.note(ImGui::SliderFloat("Normal strength", &m.normalScale, 0, 3));
    if (m.clearcoat > 0) {
        edit.note(ImGui::SliderFloat("Clear coat", &m.clearcoat, 0, 1));
        edit.note(ImGui::SliderFloat("Coat roughness", &m.clearcoatRoughness, 0, 1));
    }
}

void drawSelection(ViewerState& state, Edit& edit) {
    if (!ImGui::CollapsingHeader("Selection", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const Scene& scene = state.document->scene();
    if (!state.selectedSurface) {
        wrapped("Click an object in the picture.");
        return;
    }
    const Surface& surface = scene.surfaces[*state.selectedSurface];
    Material& material = edit.next.materials[surface.material];
    text(fmt::format("{}, material {}", surface.name, material.name.empty() ? "(unnamed)" : material.name));
    drawMaterial(edit, material);
    if (ImGui::Button("Reset material")) {
        material = state.document->edits.original().materials[surface.material];
        edit.changed = true;
    }
}

void drawLights(ViewerState& state, Edit& edit) {
    if (edit.next.lights.empty() || !ImGui::CollapsingHeader("Lights")) return;
    bool stale = false;
    for (size_t i = 0; i < edit.next.lights.size(); ++i) {
        ImGui::PushID(int(i));
        PunctualLight& light = edit.next.lights[i];
        text(light.name);
        float power = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
        glm::vec3 color = power > 0 ? light.intensity / power : glm::vec3(1);
        bool changed = ImGui::ColorEdit3("Colour", &color.x, ImGuiColorEditFlags_Float);
        changed |= ImGui::DragFloat("Intensity", &power, 0.01f * std::max(power, 0.1f), 0, 1e6f, "%.3g");
        if (changed) light.intensity = power * color;
        edit.note(changed);
        stale |= light.intensity != state.document->edits.original().lights[i].intensity;
        ImGui::PopID();
    }
    if (stale) wrapped("Direct light follows at once; indirect light is that of the bake.");
}

void drawPerformance(const Pictures& pictures) {
    if (!ImGui::CollapsingHeader("Performance")) return;
    const FrameTimes times = pictures.frameTimes();
    const auto row = [](const char* name, double seconds) {
        text(fmt::format("{:<10}{:9.2f} ms", name, 1e3 * seconds));
    };
    row("relight", times.relight);
    row("pyramid", times.pyramid);
    row("shadows", times.shadows);
    row("display", times.display);
    text(fmt::format("one of {0} x {0} pixels", pictures.coarseness()));
}

void drawKeep(ViewerState& state, bool turning, PanelWishes& wishes) {
    if (!ImGui::CollapsingHeader("Keep")) return;
    wishes.keepPicture = ImGui::Button("Picture (P)");
    ImGui::SameLine();
    wishes.copyCommand = ImGui::Button("Copy render command");
    ImGui::BeginDisabled(!state.document->hasBake);
    wishes.save = ImGui::Button("Save (Ctrl+S)");
    ImGui::SameLine();
    if (turning)
        wishes.stopTurntable = ImGui::Button("Stop the turntable");
    else if (ImGui::Button("Turntable"))
        wishes.turntableFrames = kTurntableFrames;
    ImGui::EndDisabled();
}

void drawKeys() {
    if (!ImGui::CollapsingHeader("Keys")) return;
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
    return report.samples >= report.wanted ? std::string(source)
                                           : fmt::format("{}, {} samples", source, report.samples);
}

// Files to choose from.
void drawFiles(const ViewerState& state, PanelWishes& wishes) {
    if (state.fileChanged) {
        wrapped("The file has changed on disk.");
        ImGui::SameLine();
        if (ImGui::SmallButton("Read it again")) wishes.open = state.document->path;
    }
    if (state.recentFiles.empty() || !ImGui::CollapsingHeader("Recent files")) return;
    for (const std::string& path : state.recentFiles)
        if (ImGui::Selectable(path.c_str())) wishes.open = path;
}

// What each side shows, at the window's lower edge.
void drawLabels(const ViewerState& state, const Pictures& pictures, float leftEdge) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetTextLineHeight();
    const auto label = [&](float x, const std::string& words) {
        const ImVec2 place(x, size.y - 2 * line);
        list->AddText({place.x + 1, place.y + 1}, IM_COL32(0, 0, 0, 255), words.c_str());
        list->AddText(place, IM_COL32(255, 255, 255, 255), words.c_str());
    };
    const auto width = [](const std::string& words) { return ImGui::CalcTextSize(words.c_str()).x; };
    const std::string left = samplesLine(kSourceNames[size_t(state.view.left)], pictures.left());
    if (!state.view.compare) {
        label(size.x - width(left) - line, left);
        return;
    }
    const std::string right = samplesLine(kSourceNames[size_t(state.view.right)], pictures.right());
    const float wipe = leftEdge + state.view.wipe * (size.x - leftEdge);
    if (!state.view.difference) list->AddLine({wipe, 0}, {wipe, size.y}, IM_COL32(255, 255, 255, 160));
    label(std::max(wipe - width(left) - line, leftEdge), left);
    label(std::min(wipe + line, size.x - width(right)), right);
}

}  // namespace

float panelWidth(float uiScale) {
    return kPanelWidth * uiScale;
}

PanelWishes drawPanels(ViewerState& state, const PanelInput& input) {
    PanelWishes wishes;
    if (state.document)
        drawLabels(state, input.pictures, state.view.panels ? panelWidth(input.uiScale) : 0.0f);
    if (!state.view.panels) return wishes;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({panelWidth(input.uiScale), ImGui::GetIO().DisplaySize.y});
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings;
    ImGui::Begin("panels", nullptr, flags);
    ImGui::PushItemWidth(-ImGui::GetFontSize() * 8);
    if (!input.bakeStatus.empty()) {
        wrapped(input.bakeStatus);
        ImGui::ProgressBar(input.bakeShare);
    }
    if (!state.message.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.7f, 0.4f, 1));
        wrapped(state.message);
        ImGui::PopStyleColor();
    }
    drawFiles(state, wishes);
    if (!state.document) {
        wrapped("Drop a .glb, .gltf or baked .phat.glb file on this window.");
    } else {
        Edit edit{state.document->edits.now()};
        drawPicture(state);
        drawSelection(state, edit);
        drawLights(state, edit);
        drawCompare(state, input.pictures);
        drawPerformance(input.pictures);
        drawKeep(state, input.turning, wishes);
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
    return wishes;
}

}  // namespace phat
