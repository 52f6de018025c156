#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/phat/bake_record.h"
#include "viewer/panel_parts.h"

namespace phat {
namespace {

// Its strength and colour, so that a light can be dimmed without changing its tint.
void drawEmission(Edit& edit, Material& m, bool glows) {
    if (!glows || m.unlit) return;
    float power = std::max({m.emission.x, m.emission.y, m.emission.z});
    glm::vec3 color = power > 0 ? m.emission / power : glm::vec3(1);
    bool changed = widgets::dragPositive("Emission, nit", &power);
    if (power > 0) changed |= widgets::colorEdit("Emission colour", &color.x);
    if (changed) m.emission = power * color;
    edit.note(changed);
}

void drawMaterial(Edit& edit, Material& m, bool glows) {
    const auto slider = [&](const char* label, float& value, float most) {
        edit.note(widgets::sliderFloat(label, &value, 0, most, "%.3f", ImGuiSliderFlags_AlwaysClamp));
    };
    slider("Roughness", m.roughness, 1);
    slider("Metallic", m.metallic, 1);
    edit.note(widgets::colorEdit("Base colour", &m.baseColor.x));
    slider("Specular", m.specular, 1);
    drawEmission(edit, m, glows);
    if (m.normalTexture.image >= 0) slider("Normal strength", m.normalScale, 3);
    if (m.transmission > 0) slider("Transmission", m.transmission, 1);
    if (m.clearcoat > 0) {
        slider("Clear coat", m.clearcoat, 1);
        slider("Coat roughness", m.clearcoatRoughness, 1);
    }
}

// The sky turns by whole columns of its picture, so that a file keeps every one of its values.
void drawSky(Edit& edit, int width) {
    float degrees = 360 * float(edit.next.environmentColumns) / float(width);
    if (widgets::sliderFloat("Environment rotation", &degrees, -180, 180, "%.1f degrees",
                             ImGuiSliderFlags_AlwaysClamp)) {
        edit.next.environmentColumns = int(std::lround(degrees / 360 * float(width)));
        edit.changed = true;
    }
    if (edit.next.environmentColumns != 0)
        wrappedText("The visible environment rotates at once; the light from it stays as baked.");
}

}  // namespace

void drawSelectionPanel(ViewerState& state, Edit& edit) {
    if (!widgets::header("Selection", ImGuiTreeNodeFlags_DefaultOpen)) return;
    const Scene& scene = state.document->scene();
    if (!state.selectedSurface) {
        wrappedText("Click an object in the picture.");
        return;
    }
    const Surface& surface = scene.surfaces[*state.selectedSurface];
    Material& material = edit.next.materials[surface.material];
    wrappedText(
        fmt::format("{}, material {}", surface.name, material.name.empty() ? "(unnamed)" : material.name));
    // Without any area light at the start there are no PHATexels for such light, unless they were asked for.
    const bool canGlow = !state.document->baked.phatexture.area.empty();
    const glm::vec3 original = state.document->edits.original().materials[surface.material].emission;
    const bool mayGlow = original != glm::vec3(0) || settingsOf(state.document->baked.record).dynamic;
    drawMaterial(edit, material, canGlow && mayGlow);
    if (widgets::button("Reset material")) {
        material = state.document->edits.original().materials[surface.material];
        edit.changed = true;
    }
}

void drawLightsPanel(ViewerState& state, Edit& edit) {
    const auto& sky = state.document->scene().environment;
    if ((edit.next.lights.empty() && !sky) || !widgets::header("Lights")) return;
    state.switchedOff.resize(edit.next.lights.size());
    for (size_t i = 0; i < edit.next.lights.size(); ++i) {
        ImGui::PushID(int(i));
        PunctualLight& light = edit.next.lights[i];
        wrappedText(light.name);
        float power = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
        glm::vec3 color = power > 0 ? light.intensity / power : glm::vec3(1);
        bool changed = widgets::colorEdit("Colour", &color.x);
        changed |= widgets::dragPositive("Intensity", &power);
        if (changed) light.intensity = power * color;
        edit.note(changed);
        bool shines = light.intensity != glm::vec3(0);
        if (widgets::checkbox("On", &shines)) {
            if (!shines) state.switchedOff[i] = light.intensity;
            // It comes back as it was.
            light.intensity = shines ? state.switchedOff[i].value_or(glm::vec3(1)) : glm::vec3(0);
            edit.changed = true;
        }
        if (light.photometry) drawPhotometry(light);
        if (light.type != PunctualLight::Type::directional)
            edit.note(widgets::dragVector("Position, m", &light.position.x, 0.01f, "%.2f"));
        ImGui::PopID();
    }
    if (sky) drawSky(edit, sky->radiance.width);
}

}  // namespace phat
