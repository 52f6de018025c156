// What a lamp with photometry emits, in the panel of the lights.

#include <fmt/format.h>

#include <vector>

#include "viewer/panel_parts.h"

namespace phat {
namespace {

constexpr int kPlaces = 60;        // of half a turn
constexpr float kHeightLines = 7;  // of text

// Polar: the distance from the middle is the intensity in that direction, straight ahead being down.
void drawCurve(const Photometry& photometry, ImVec2 middle, float radius, float plane, ImU32 color) {
    std::vector<ImVec2> points;
    for (int place = -kPlaces; place <= kPlaces; ++place) {
        const float angle = kPi * float(place) / kPlaces, sine = std::sin(angle), cosine = std::cos(angle);
        const float length =
            radius * photometry.at({sine * std::cos(plane), sine * std::sin(plane), -cosine});
        points.emplace_back(middle.x + length * sine, middle.y + length * cosine);
    }
    ImGui::GetWindowDrawList()->AddPolyline(points.data(), int(points.size()), color, 0, 1.5f);
}

}  // namespace

void drawPhotometry(const PunctualLight& light) {
    const Photometry& photometry = *light.photometry;
    const float peak = luminance(light.intensity);
    valueRow(photometry.web().name,
             fmt::format("{:.4g} lm, {:.4g} cd", peak * photometry.solidAngle(), peak));
    const float height = kHeightLines * ImGui::GetTextLineHeight(), width = ImGui::GetContentRegionAvail().x;
    const ImVec2 corner = ImGui::GetCursorScreenPos(),
                 middle(corner.x + 0.5f * width, corner.y + 0.5f * height);
    const float radius = 0.5f * height;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 faint = ImGui::GetColorU32(ImGuiCol_TextDisabled, 0.4f);
    for (const float part : {0.5f, 1.0f}) list.AddCircle(middle, part * radius, faint);
    list.AddLine({middle.x, middle.y - radius}, {middle.x, middle.y + radius}, faint);
    drawCurve(photometry, middle, radius, 0.5f * kPi, ImGui::GetColorU32(ImGuiCol_TextDisabled));
    drawCurve(photometry, middle, radius, 0, ImGui::GetColorU32(ImGuiCol_PlotLines));
    ImGui::Dummy({width, height});
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "Intensity by direction, down being where the lamp points;\n"
            "bright: in the plane of horizontal angle 0, dim: of 90 degrees");
}

}  // namespace phat
