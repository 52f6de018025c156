#pragma once
// Insides of a scene: where one could stand in a room.

#include <vector>

#include "core/scene/rays.h"

namespace phat {

/// Box around the triangles without a ground: flat triangles beneath all else that reach much farther than
/// it. Of a scene that is nothing else, all.
Bounds boundsWithoutGround(const Scene& scene);
/// Whether each triangle counts for that box.
std::vector<bool> trianglesWithoutGround(const Scene& scene);

/// An eye between a floor and a ceiling, with surfaces around it nearly everywhere.
struct StandPoint {
    glm::vec3 eye{0};
    float floorHeight = 0;
    float roomHeight = 0;     // from the floor to the ceiling
    float nearest = 0;        // to any surface
    float frontFraction = 0;  // of the surfaces around it
};

/// Eyes in rooms, on a grid over the scene, at the height of kEyeMeters, also in rooms that seem to be in
/// centimetres, millimetres or kilometres; where the room is in no known unit, of kEyeFraction of it. Of the
/// storey that has most of them. Empty where the scene has no inside. The same for any number of threads.
std::vector<StandPoint> standPoints(const RayScene& rays);
/// The same of all storeys.
std::vector<StandPoint> standPointsOfAllStoreys(const RayScene& rays);

/// Where an eye is in a room of any storey: boxes from floor to ceiling around the places where one could
/// stand, so wide that they reach the walls. Together they follow the rooms' ground plan to within a step of
/// that grid and a shoulder. Empty where the scene has no inside.
std::vector<Bounds> roomBoxes(const RayScene& rays);

inline constexpr float kEyeMeters = 1.6f;
inline constexpr float kEyeFraction = 0.6f;

}  // namespace phat
