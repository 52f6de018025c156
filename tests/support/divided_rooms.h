#pragma once
// Rooms on a floor that is larger than they are.

#include "support/scene_builder.h"

namespace phat::test {

/// Six quads that look outward.
inline void addBox(Scene& scene, const Material& material, glm::vec3 low, glm::vec3 high) {
    const glm::vec3 size = high - low;
    for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 along(0), across(0), far(0);
        along[(axis + 1) % 3] = size[(axis + 1) % 3];
        across[(axis + 2) % 3] = size[(axis + 2) % 3];
        far[axis] = size[axis];
        addQuad(scene, material, low, across, along);
        addQuad(scene, material, low + far, along, across);
    }
}

/// Where the walls of a room end below.
struct RoomOnFloor {
    float floor = 6;     // side; the room's is 2 m, and 1 m high
    float wall = 0.02f;  // thickness
    float foot = -0.1f;  // height of the walls' lower ends
    float doorway = 0;   // width of a gap in the wall at x = 1
};

/// A sky over a floor and, on it, a room: walls that reach into one another, and a roof whose edges are
/// theirs. Surface 0 is the floor.
inline Scene roomOnFloor(const RoomOnFloor& room = {}) {
    Scene scene;
    addFloor(scene, lambert(0.6f), room.floor);
    const Material wall = lambert(0.6f);
    const float in = 1, out = in + room.wall, low = room.foot, high = 1;
    addBox(scene, wall, {-out, low, -out}, {-in, high, out});
    addBox(scene, wall, {in, low, -out}, {out, high, -0.5f * room.doorway});
    addBox(scene, wall, {in, low, 0.5f * room.doorway}, {out, high, out});
    addBox(scene, wall, {-out, low, -out}, {out, high, -in});
    addBox(scene, wall, {-out, low, in}, {out, high, out});
    addBox(scene, wall, {-out, high, -out}, {out, high + room.wall, out});
    Image sky(4, 2);
    for (glm::vec3& pixel : sky.pixels) pixel = glm::vec3(1);
    scene.environment = Environment{sky};
    return scene;
}

}  // namespace phat::test
