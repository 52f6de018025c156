#include "core/phatexel/direction_cells.h"

namespace phat {

int cellOfDirection(glm::vec3 direction) {
    const glm::vec2 square = hemisphereToSquare(direction) * float(kGuideSize);
    const glm::ivec2 cell = glm::clamp(glm::ivec2(square), 0, kGuideSize - 1);
    return cell.y * kGuideSize + cell.x;
}

glm::vec3 directionInCell(int cell, glm::vec2 inCell) {
    const glm::vec2 corner(cell % kGuideSize, cell / kGuideSize);
    return squareToHemisphere((corner + inCell) / float(kGuideSize));
}

float meanCosine(int cell) {
    static const std::array<float, kGuideCells> means = [] {
        constexpr int kSteps = 16;
        std::array<float, kGuideCells> result{};
        for (int index = 0; index < kGuideCells; ++index)
            for (int step = 0; step < kSteps * kSteps; ++step) {
                const glm::vec2 inCell = (glm::vec2(step % kSteps, step / kSteps) + 0.5f) / float(kSteps);
                result[size_t(index)] += directionInCell(index, inCell).z / float(kSteps * kSteps);
            }
        return result;
    }();
    return means[size_t(cell)];
}

glm::vec3 storableDirection(glm::vec3 direction) {
    constexpr float kMargin = 0.01f;  // of a cell; twice what rounding moves
    const auto round = [](glm::vec3 d) { return unpackOctahedral24(packOctahedral24(d)); };
    const glm::vec2 exact = hemisphereToSquare(direction) * float(kGuideSize);
    const glm::vec2 cell = glm::min(glm::floor(exact), float(kGuideSize - 1));
    glm::vec3 rounded = round(direction);
    rounded.z = std::max(rounded.z, 0.0f);
    const glm::vec2 square = hemisphereToSquare(rounded) * float(kGuideSize);
    const glm::vec2 inside = glm::clamp(square, cell + kMargin, cell + 1.0f - kMargin);
    if (inside == square) return rounded;
    return round(squareToHemisphere(inside / float(kGuideSize)));
}

}  // namespace phat
