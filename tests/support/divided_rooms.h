#pragma once
// Rooms on a floor that is larger than they are.

#include "support/scene_builder.h"

namespace phat::test {

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
    const auto between = [&](glm::vec3 from, glm::vec3 to) { addOutwardBox(scene, wall, from, to - from); };
    const float in = 1, out = in + room.wall, low = room.foot, high = 1;
    between({-out, low, -out}, {-in, high, out});
    between({in, low, -out}, {out, high, -0.5f * room.doorway});
    between({in, low, 0.5f * room.doorway}, {out, high, out});
    between({-out, low, -out}, {out, high, -in});
    between({-out, low, in}, {out, high, out});
    between({-out, high, -out}, {out, high + room.wall, out});
    Image sky(4, 2);
    for (glm::vec3& pixel : sky.pixels) pixel = glm::vec3(1);
    scene.environment = Environment{sky};
    return scene;
}

}  // namespace phat::test
