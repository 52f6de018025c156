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

/// Cuts the triangles of a scene, each into a constrained Delaunay triangulation of the lines on it. The
/// scene's own edges are split in all triangles that have them, of all surfaces, so that no new vertex lies
/// on the edge of a triangle without being one of its corners: a picture would have holes there. Vertices are
/// those of the scene and, behind them, new ones.
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
    struct Crossed {  // an edge that a line crosses
        uint32_t left, right;
    };
    struct Way;

    // The mesh. Vertices are given by their welded indices.
    uint32_t addVertex(const CutVertex& vertex, glm::dvec3 position, uint32_t welded);
    uint32_t addTriangle(glm::uvec3 corners, uint32_t origin);
    void setTriangle(uint32_t triangle, glm::uvec3 corners);
    uint32_t splitTriangle(uint32_t triangle, glm::dvec3 point);
    uint32_t splitEdge(uint32_t a, uint32_t b, double t);
    bool canFlip(Edge edge) const;
    Edge flip(Edge edge);
    bool isDelaunay(Edge edge) const;
    void makeDelaunay(std::vector<Edge> open);
    int cornerAcross(uint32_t triangle, Edge edge) const;
    uint32_t vertexAcross(uint32_t triangle, Edge edge) const;
    std::array<Edge, 3> edgesOf(uint32_t triangle) const;

    // Lines on a triangle of the scene.
    std::vector<uint32_t> piecesNear(uint32_t sceneTriangle, glm::dvec3 from, glm::dvec3 to);
    void addToGrid(TriangleGrid& grid, uint32_t piece) const;
    Line lineBetween(uint32_t sceneTriangle, uint32_t from, uint32_t to) const;
    uint32_t insertPoint(uint32_t sceneTriangle, glm::dvec3 point);
    Way follow(uint32_t sceneTriangle, uint32_t from, uint32_t to);
    std::vector<uint32_t> splitSections(const Line& line, const std::vector<Crossed>& crossed);
    void retriangulate(uint32_t from, const Way& way);
    void triangulate(std::span<const uint32_t> polygon, std::vector<glm::uvec3>& corners) const;

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
