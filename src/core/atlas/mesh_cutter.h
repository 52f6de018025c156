#pragma once
// Cutting triangles along lines, so that the lines become edges of the mesh.

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/atlas/mesh_topology.h"
#include "core/atlas/triangle_grid.h"
#include "core/atlas/wall_sections.h"

namespace phat {

/// A vertex that a cut has made, as a mean of earlier ones of its surface.
struct CutVertex {
    std::array<uint32_t, 3> from{};
    std::array<double, 3> weight{};  // sum 1
};

/// Cuts the triangles of a scene. Edges are split in all triangles that have them, of all surfaces, so that
/// no new vertex lies on the edge of a triangle without being one of its corners: a picture would have holes
/// there. Vertices are those of the scene and, behind them, new ones.
class MeshCutter {
  public:
    /// `toleranceMeters`: what is nearer to a line or a vertex is on it.
    MeshCutter(const Scene& scene, const MeshTopology& topology, double toleranceMeters);

    /// Makes a line on a triangle of the scene a sequence of edges; `number` is remembered with them.
    void cut(const WallSection& section, uint32_t number);

    const std::vector<glm::uvec3>& triangles() const { return triangles_; }
    uint32_t origin(uint32_t triangle) const { return origin_[triangle]; }  // in the scene
    std::span<const CutVertex> newVertices() const { return added_; }
    glm::dvec3 position(uint32_t vertex) const { return positions_[vertex]; }

    /// An edge of the cut mesh by position, with the triangles that have it.
    using Edge = uint64_t;
    Edge edgeOf(uint32_t a, uint32_t b) const;
    const std::unordered_map<Edge, std::vector<uint32_t>>& edges() const { return edges_; }
    /// The sections that an edge lies on; none: null.
    const std::vector<uint32_t>* sectionsOf(Edge edge) const;

  private:
    struct Line;
    std::vector<uint32_t> piecesNear(uint32_t sceneTriangle, glm::dvec3 from, glm::dvec3 to);
    void addToGrid(TriangleGrid& grid, uint32_t piece) const;
    double toLine(const Line& line, uint32_t vertex) const;
    void insertPoint(uint32_t sceneTriangle, glm::dvec3 point);
    void splitTriangle(uint32_t triangle, glm::dvec3 point);
    void splitEdge(uint32_t a, uint32_t b, double t);
    bool splitAcross(const Line& line, uint32_t triangle);
    uint32_t addVertex(const CutVertex& vertex, glm::dvec3 position, uint32_t welded);
    uint32_t addTriangle(glm::uvec3 corners, uint32_t origin);
    void setTriangle(uint32_t triangle, glm::uvec3 corners);

    const Scene& scene_;
    const MeshTopology& topology_;
    double tolerance_;
    std::vector<glm::dvec3> positions_;
    std::vector<uint32_t> welded_;  // per vertex: stands for all at its position
    std::vector<CutVertex> added_;
    std::vector<glm::uvec3> triangles_;
    std::vector<uint32_t> origin_;
    std::vector<std::vector<uint32_t>> pieces_;         // per triangle of the scene
    std::unordered_map<uint32_t, TriangleGrid> grids_;  // of those with many pieces
    std::unordered_map<Edge, std::vector<uint32_t>> edges_;
    std::unordered_map<Edge, std::vector<uint32_t>> sections_;
};

}  // namespace phat
