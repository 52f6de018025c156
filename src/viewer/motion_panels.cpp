// Animation, transforms and dynamic lighting.

#include <fmt/format.h>

#include "viewer/panel_parts.h"

namespace phat {
namespace {

void drawNodeMotion(ViewerState& state, Edit& edit) {
    if (!state.selectedSurface) {
        wrappedText("Click an object in the picture; G moves it, R turns it.");
        return;
    }
    const Surface& surface = state.document->scene().surfaces[*state.selectedSurface];
    // Without effect it is no edit until a field is changed.
    NodeMotion& motion = motionFor(edit.next.motions, state.document->scene(), surface.node);
    panelText(surface.name);
    edit.note(widgets::dragVector("Translation, m", &motion.meters.x,
                                  0.005f * state.document->rays().unitMeters(), "%.4g"));
    edit.note(widgets::dragVector("Rotation, degrees", &motion.degrees.x, 0.5f, "%.1f"));
    if (widgets::button("Reset transform")) {
        motion.meters = motion.degrees = glm::vec3(0);
        edit.changed = true;
    }
}

void drawPlayback(ViewerState& state) {
    const std::vector<Animation>& animations = state.document->scene().animations;
    if (animations.empty()) return;
    Playback& playback = state.document->playback;
    const auto nameOf = [&](int i) {
        if (i < 0) return std::string("at rest");
        const std::string& name = animations[size_t(i)].name;
        return name.empty() ? fmt::format("animation {}", i) : name;
    };
    if (widgets::beginList("Animation", nameOf(playback.animation).c_str())) {
        for (int i = -1; i < int(animations.size()); ++i) {
            ImGui::PushID(i);
            if (widgets::listItem("Animation", nameOf(i), i == playback.animation)) playback = {i, 0, false};
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    const int index = std::max(playback.animation, 0);
    float seconds = float(playback.seconds);
    if (widgets::sliderFloat("Time, s", &seconds, 0, animations[size_t(index)].seconds(), "%.2f",
                             ImGuiSliderFlags_AlwaysClamp))
        playback = {index, double(seconds), false};
    if (widgets::button(playback.playing ? "Pause" : "Play"))
        playback = {index, playback.seconds, !playback.playing};
}

}  // namespace

void drawMotionPanel(ViewerState& state, Edit& edit) {
    // What can play is shown to do so.
    ImGui::SetNextItemOpen(!state.document->scene().animations.empty(), ImGuiCond_Once);
    if (!widgets::header("Transform")) return;
    drawPlayback(state);
    drawNodeMotion(state, edit);
}

void drawLivePanel(ViewerState& state, const PanelInput& input) {
    if (!widgets::header("Dynamic lighting")) return;
    widgets::checkbox("Update lighting (L)", &state.view.liveLight);
    widgets::checkbox("Refine at rest (Shift+L)", &state.view.refine);
    if (!input.light) {
        wrappedText("Indirect lighting is updated when an object, a light or a material changes.");
        return;
    }
    const BakerThread::Report& report = *input.light;
    ImGui::ProgressBar(report.converged && state.view.liveLight ? 1.0f : overall(report.upToDate));
    constexpr std::array<const char*, kBakerTasks> kNames = {"moved texels", "retraced rays",   "photons",
                                                             "area lights",  "irradiance rays", "irradiance",
                                                             "PHATexels"};
    for (size_t t = 0; t < kBakerTasks; ++t)
        valueRow(kNames[t], fmt::format("{:.0f} %", 100 * report.upToDate[t]));
    panelText(fmt::format("{:.0f} thousand PHATexels a second", 1e-3 * report.phatexelsPerSecond));
    panelText(
        fmt::format("{:.2f} million updated in {:.1f} s", 1e-6 * double(report.phatexels), report.seconds));
    if (report.refinements > 0) panelText(fmt::format("refined {} times", report.refinements));
}

}  // namespace phat
