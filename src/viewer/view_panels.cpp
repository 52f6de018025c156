#include <fmt/format.h>

#include <algorithm>

#include "viewer/panel_parts.h"
#include "viewer/texel_probe.h"

namespace phat {
namespace {

// In the order of Inspected, after Inspected::nothing.
constexpr std::array<const char*, 9> kInspectedNames = {"radiance", "directions",   "hit distance",
                                                        "validity", "charts",       "density",
                                                        "pyramid",  "sample count", "texel reads"};
constexpr std::array<const char*, 9> kLegends = {
    "The radiance that each PHATexel stores.",
    "Where it comes from: x, y, z as red, green, blue.",
    "How far that is, in metres: black {:.3g}, red {:.3g}, yellow {:.3g}, white {:.3g} and more.",
    "Green: holds a value. Red: occluded or inside objects.",
    "Each chart has a colour, and a checker of its tiles of 8x8 texels.",
    "A checker of texels. Blue: as coarse as anywhere. Red: an eighth of that.",
    "The PHATexels times the BRDF, summed up level by level, as the eye sees them.",
    "Effective number in the pyramid's cone: black 1, red 6, yellow 40, white 256.",
    "Texels read for the glossy light of a pixel: black none, red 85, yellow 170, white 256."};

// What the colours of a view of stored data mean. `unitMeters`: Atlas::unitMeters, by which distances are
// shown.
std::string legendOf(Inspected what, float unitMeters) {
    const char* legend = kLegends[size_t(what) - 1];
    if (what != Inspected::distance) return legend;
    return fmt::format(fmt::runtime(legend), 0.01f * unitMeters, 0.22f * unitMeters, 4.6f * unitMeters,
                       100 * unitMeters);
}

void drawCameras(ViewerState& state) {
    const auto& cameras = state.document->scene().cameras;
    const char* shown = state.camera < 0  ? "free"
                        : cameras.empty() ? "overview"
                                          : cameras[size_t(state.camera)].name.c_str();
    if (!widgets::beginList("Camera", shown)) return;
    for (size_t i = 0; i < std::max<size_t>(cameras.size(), 1); ++i) {
        ImGui::PushID(int(i));
        if (widgets::listItem("Camera", cameras.empty() ? "overview" : cameras[i].name,
                              state.camera == int(i)))
            showCamera(state, int(i));
        ImGui::PopID();
    }
    ImGui::EndCombo();
}

void row(const char* name, double milliseconds) {
    valueRow(name, fmt::format("{:.2f} ms", milliseconds));
}

void sizeRow(const char* name, uint64_t bytes) {
    valueRow(name, fmt::format("{:.1f} MB", double(bytes) * 1e-6));
}

void drawReads(const Pictures::Reads& reads) {
    const auto line = [](const char* source, ReadCount count) {
        valueRow(source, fmt::format("{:.1f} reads, at most {:.0f}", count.mean, count.most));
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
        panelText("invalid");
    else if (p.distance >= kFarDistance)
        wrappedText(fmt::format("{:.3g} {:.3g} {:.3g} W/(m2 sr) from infinity", p.radiance.r, p.radiance.g,
                                p.radiance.b));
    else
        wrappedText(fmt::format("{:.3g} {:.3g} {:.3g} W/(m2 sr) from {:.3g} m", p.radiance.r, p.radiance.g,
                                p.radiance.b, p.distance));
}

}  // namespace

void drawPicturePanel(ViewerState& state) {
    if (!widgets::header("View", ImGuiTreeNodeFlags_DefaultOpen)) return;
    ViewSettings& view = state.view;
    drawCameras(state);
    bool changed = choose("Method", view.left, kSourceNames);
    constexpr std::array<const char*, 5> kComponents = {"all", "direct", "indirect", "glossy indirect",
                                                        "diffuse indirect"};
    changed |= choose("Component", view.component, kComponents);
    // Tone and exposure are applied on the way to the window.
    widgets::sliderFloat("Exposure", &view.exposureStops, -16, 16, "%.1f stops");
    if (widgets::button("Expose for this view")) meterExposure(state);
    constexpr std::array<const char*, 3> kToneMaps = {"linear", "AgX", "ACES"};
    choose("Tone mapping", view.toneMap, kToneMaps);
    changed |= widgets::checkbox("Trace sharp reflections", &view.traced);
    if (changed) state.touch();
}

void drawComparePanel(ViewerState& state, const Pictures& pictures) {
    ImGui::SetNextItemOpen(state.view.compare, ImGuiCond_Appearing);
    if (!widgets::header("Compare")) return;
    ViewSettings& view = state.view;
    widgets::checkbox("Split view", &view.compare);  // the left picture stays as far as it is
    if (choose("Right side", view.right, kSourceNames)) state.touch();
    widgets::sliderFloat("Split position", &view.wipe, 0, 1, "%.2f");
    widgets::checkbox("Show difference", &view.difference);
    if (!view.compare || view.left == Source::phatexels || view.right == Source::phatexels) return;
    if (const auto metrics = pictures.metrics()) {
        valueRow("MAE/mean", fmt::format("{:.4f}", metrics->maeOverMean));
        valueRow("bias", fmt::format("{:+.2f} %", 100 * metrics->bias));
        valueRow("relMSE", fmt::format("{:.4f}", metrics->relMse));
        valueRow("FLIP", fmt::format("{:.4f}", metrics->flip));
    } else {
        panelText("measuring ...");
    }
}

void drawPhatexelPanel(ViewerState& state, const Pictures& pictures) {
    if (!widgets::header("PHATexels")) return;
    ViewSettings& view = state.view;
    Inspection& inspection = view.inspection;
    ImGui::BeginDisabled(!state.document->hasBake);
    if (widgets::button("Compare PHATexels with the result")) {
        inspection = {Inspected::radiance};
        view.left = Source::phatexels;
        view.right = Source::phat;
        view.compare = true;
        view.difference = false;
        state.touch();
    }
    bool changed = false;
    int index = int(inspection.what) - 1;
    if (widgets::list("Quantity", &index, kInspectedNames)) {
        inspection.what = Inspected(index + 1);
        view.left = Source::phatexels;
        changed = true;
    }
    const Phatexture& phatexture = state.document->baked.phatexture;
    constexpr std::array<const char*, 2> kSources = {"indirect", "area lights"};
    if (!phatexture.area.empty()) changed |= choose("Light source", inspection.source, kSources);
    const size_t layers = (inspection.source == 0 ? phatexture.indirect : phatexture.area).size();
    if (layers > 1) changed |= widgets::sliderInt("Layer", &inspection.layer, 0, int(layers) - 1);
    if (inspection.what == Inspected::pyramid)
        changed |= widgets::sliderInt("Level", &inspection.level, 0, 3, ImGuiSliderFlags_AlwaysClamp);
    const bool lookedUp = state.renderer && state.renderer->bytesPerPhatexel() > 0;
    wrappedText(inspection.what == Inspected::reads && !lookedUp
                    ? "These PHATexels cannot be looked up."
                    : legendOf(inspection.what, state.document->baked.atlas.unitMeters));
    if (const auto reads = pictures.reads(); reads && inspection.what == Inspected::reads) drawReads(*reads);
    if (view.left == Source::phatexels) {
        if (widgets::button("Show rendered image")) {
            view.left = Source::phat;
            changed = true;
        }
    } else if (widgets::button("Show PHATexels")) {
        view.left = Source::phatexels;
        changed = true;
    }
    ImGui::EndDisabled();
    if (state.document->hasBake) drawTexelUnderMouse(state);
    if (changed) state.touch();
}

void drawPerformancePanel(ViewerState& state, const Pictures& pictures) {
    if (!widgets::header("Performance") || !state.renderer) return;
    const FrameTimes times = pictures.frameTimes();
    for (const NamedPass& pass : kGpuPasses) row(pass.name, 1e3 * times.*pass.seconds);
    row("GPU total", 1e3 * times.gpu());
    row("CPU rays", 1e3 * pictures.reflectionSeconds());
    valueRow("Window pixels per rendered pixel", fmt::format("{0} x {0}", pictures.coarseness()));
    if (pictures.tooManyRays())
        wrappedText("Sharp reflections are looked up, because tracing them would take too long.");
    ImGui::Separator();
    const ResidentBytes bytes = state.renderer->residentBytes();
    sizeRow("scene", bytes.scene);
    sizeRow("PHATexels", bytes.phatexels);
    sizeRow("lookup tables", bytes.lookup);
    sizeRow("irradiance", bytes.irradiance);
    sizeRow("pyramid", bytes.pyramid);
    sizeRow("shadow maps", bytes.shadows);
    sizeRow("frame", bytes.frame);
    sizeRow("total", bytes.sum());
    ImGui::Separator();
    if (const auto reads = pictures.reads())
        drawReads(*reads);
    else
        wrappedText("Texel reads are counted while PHATexels shows the quantity \"texel reads\".");
}

}  // namespace phat
