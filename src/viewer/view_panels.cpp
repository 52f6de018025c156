#include <fmt/format.h>

#include <algorithm>

#include "viewer/panel_parts.h"
#include "viewer/texel_probe.h"

namespace phat {
namespace {

// In the order of Inspected, after Inspected::nothing.
constexpr std::array<const char*, 9> kInspectedNames = {"radiance", "directions",   "hit distance",
                                                        "validity", "charts",       "density",
                                                        "pyramid",  "sample count", "reads of texels"};
constexpr std::array<const char*, 9> kLegends = {
    "The radiance that each PHATexel stores.",
    "Where it comes from: x, y, z as red, green, blue.",
    "How far that is: black 1 cm, red 22 cm, yellow 4.6 m, white 100 m and more.",
    "Green: holds a value. Red: covered or inside things.",
    "Each chart has a colour, and a checker of its tiles of 8x8 texels.",
    "A checker of texels. Blue: as coarse as anywhere. Red: an eighth of that.",
    "The PHATexels times the BRDF, summed up level by level, as the eye sees them.",
    "Effective number in the pyramid's cone: black 1, red 6, yellow 40, white 256.",
    "Texels read for the glossy light of a pixel: black none, red 85, yellow 170, white 256."};

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

void row(const char* name, double milliseconds) {
    panelText(fmt::format("{:<20}{:9.2f} ms", name, milliseconds));
}

void sizeRow(const char* name, uint64_t bytes) {
    panelText(fmt::format("{:<20}{:9.1f} MB", name, double(bytes) * 1e-6));
}

void drawReads(const Pictures::Reads& reads) {
    const auto line = [](const char* source, ReadCount count) {
        panelText(fmt::format("{:<12} reads {:6.1f}, {:.0f} at most", source, count.mean, count.most));
    };
    line("indirect", reads.indirect);
    line("area lights", reads.area);
}

void drawTexelUnderMouse(const ViewerState& state) {
    const auto found = texelUnderMouse(state);
    if (!found) {
        panelText("No PHATexel under the mouse.");
        return;
    }
    wrappedText(fmt::format("Texel {}, {} of {:.1f} mm, chart {}", found->texel.x, found->texel.y,
                            1e3f * found->texelMeters, found->chart));
    const Phatexel& p = found->phatexel;
    if (!p.valid)
        panelText("holds no value");
    else if (p.distance >= kFarDistance)
        wrappedText(fmt::format("{:.3g} {:.3g} {:.3g} W/(m2 sr) from afar", p.radiance.r, p.radiance.g,
                                p.radiance.b));
    else
        wrappedText(fmt::format("{:.3g} {:.3g} {:.3g} W/(m2 sr) from {:.3g} m", p.radiance.r, p.radiance.g,
                                p.radiance.b, p.distance));
}

}  // namespace

void drawPicturePanel(ViewerState& state) {
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
    changed |= ImGui::Checkbox("Rays for sharp reflections at rest", &view.raysAtRest);
    if (changed) state.touch();
}

void drawComparePanel(ViewerState& state, const Pictures& pictures) {
    ImGui::SetNextItemOpen(state.view.compare, ImGuiCond_Appearing);
    if (!ImGui::CollapsingHeader("Compare")) return;
    ViewSettings& view = state.view;
    ImGui::Checkbox("Split the window", &view.compare);  // the left picture stays as far as it is
    if (choose("Right", view.right, kSourceNames)) state.touch();
    ImGui::SliderFloat("Wipe", &view.wipe, 0, 1, "%.2f");
    ImGui::Checkbox("Show the difference", &view.difference);
    if (!view.compare || view.left == Source::phatexels || view.right == Source::phatexels) return;
    if (const auto metrics = pictures.metrics()) {
        panelText(fmt::format("MAE/mean {:.4f}   bias {:+.2f} %", metrics->maeOverMean, 100 * metrics->bias));
        panelText(fmt::format("relMSE   {:.4f}   FLIP {:.4f}", metrics->relMse, metrics->flip));
    } else {
        panelText("measuring ...");
    }
}

void drawPhatexelPanel(ViewerState& state, const Pictures& pictures) {
    if (!ImGui::CollapsingHeader("PHATexels")) return;
    ViewSettings& view = state.view;
    Inspection& inspection = view.inspection;
    ImGui::BeginDisabled(!state.document->hasBake);
    if (ImGui::Button("Figure 4: PHATexels beside the result")) {
        inspection = {Inspected::radiance};
        view.left = Source::phatexels;
        view.right = Source::phat;
        view.compare = true;
        view.difference = false;
        state.touch();
    }
    bool changed = false;
    int index = int(inspection.what) - 1;
    if (ImGui::Combo("View", &index, kInspectedNames.data(), int(kInspectedNames.size()),
                     int(kInspectedNames.size()))) {
        inspection.what = Inspected(index + 1);
        view.left = Source::phatexels;
        changed = true;
    }
    const Phatexture& phatexture = state.document->baked.phatexture;
    constexpr std::array<const char*, 2> kSources = {"indirect", "area lights"};
    if (!phatexture.area.empty()) changed |= choose("PHATexels of", inspection.source, kSources);
    const size_t layers = (inspection.source == 0 ? phatexture.indirect : phatexture.area).size();
    if (layers > 1) changed |= ImGui::SliderInt("Layer", &inspection.layer, 0, int(layers) - 1);
    if (inspection.what == Inspected::pyramid)
        changed |= ImGui::SliderInt("Level", &inspection.level, 0, 3, "%d", ImGuiSliderFlags_AlwaysClamp);
    const bool lookedUp = state.renderer && state.renderer->bytesPerPhatexel() > 0;
    wrappedText(inspection.what == Inspected::reads && !lookedUp ? "These PHATexels cannot be looked up."
                                                                 : kLegends[size_t(index)]);
    if (const auto reads = pictures.reads(); reads && inspection.what == Inspected::reads) drawReads(*reads);
    if (view.left == Source::phatexels) {
        if (ImGui::Button("Back to the light")) {
            view.left = Source::phat;
            changed = true;
        }
    } else if (ImGui::Button("Show")) {
        view.left = Source::phatexels;
        changed = true;
    }
    ImGui::EndDisabled();
    if (state.document->hasBake) drawTexelUnderMouse(state);
    if (changed) state.touch();
}

void drawPerformancePanel(ViewerState& state, const Pictures& pictures) {
    if (!ImGui::CollapsingHeader("Performance") || !state.renderer) return;
    const FrameTimes times = pictures.frameTimes();
    for (const NamedPass& pass : kGpuPasses) row(pass.name, 1e3 * times.*pass.seconds);
    row("all on the GPU", 1e3 * times.gpu());
    row("rays, on the CPU", 1e3 * times.reflections);
    panelText(fmt::format("a pixel drawn for {0} x {0} of the window", pictures.coarseness()));
    if (pictures.tooManyRays())
        wrappedText("Sharp reflections are looked up: rays would take too long here.");
    ImGui::Separator();
    const ResidentBytes bytes = state.renderer->residentBytes();
    sizeRow("scene", bytes.scene);
    sizeRow("PHATexels", bytes.phatexels);
    sizeRow("lookup tables", bytes.lookup);
    sizeRow("irradiance", bytes.irradiance);
    sizeRow("pyramid", bytes.pyramid);
    sizeRow("shadow maps", bytes.shadows);
    sizeRow("frame", bytes.frame);
    sizeRow("resident in all", bytes.sum());
    ImGui::Separator();
    if (const auto reads = pictures.reads())
        drawReads(*reads);
    else
        wrappedText("Reads a pixel: choose the view \"reads of texels\" under PHATexels.");
}

}  // namespace phat
