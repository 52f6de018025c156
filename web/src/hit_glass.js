// How rays pass the surfaces of a room.
// twin: src/core/scene/transparency.cpp, thicknessOf in src/gl/hit_tables.cpp.
import { isGlass } from './material.js';

// Of a triangle, beside its material's number. twin: shaders/lib/hit_surface.glsl.
const kGlass = 0x80000000,
    kVolume = 0x40000000;

// Finds out whether triangles close a volume: each edge is run through as often in one direction as in the
// other. Vertices are one where they have the same position.
function isClosed(ranges, { indices }, positionAt) {
    const balance = new Map();
    for (const { first, count } of ranges)
        for (let at = first; at < first + count; at += 3) {
            const corners = [0, 1, 2].map((i) => positionAt(indices[at + i]).map((x) => x + 0).join());
            corners.forEach((from, i) => {
                const to = corners[(i + 1) % 3],
                    key = from < to ? `${from} ${to}` : `${to} ${from}`;
                if (from !== to) balance.set(key, (balance.get(key) ?? 0) + (from < to ? 1 : -1));
            });
        }
    return [...balance.values()].every((count) => count === 0);
}

// { bits, thickness } of each range, thickness in metres. `positionAt`: of a vertex.
export function glassOfSurfaces(surfaces, images, positionAt) {
    const { drawRanges } = surfaces,
        mayBoundVolume = ({ material }) => isGlass(material) && material.thickness > 0;
    return drawRanges.map((range) => {
        const { mesh } = range,
            { material: m } = mesh;
        if (!isGlass(m)) return { bits: 0, thickness: 0 };
        // The surfaces of one node are meshes of a group.
        const isBeside = (other) => mesh.parent?.isGroup && other.parent === mesh.parent && mayBoundVolume(other),
            ofNode = (other) => other === range || isBeside(other.mesh);
        const bounds = (ranges) => isClosed(ranges, surfaces, positionAt);
        if (mayBoundVolume(mesh) && (bounds([range]) || bounds(drawRanges.filter(ofNode))))
            return { bits: kGlass + kVolume, thickness: 0 };
        // Other than in the twin, a node's scale is the mean over all directions.
        const scale = Math.cbrt(Math.abs(mesh.matrixWorld.determinant()));
        return { bits: kGlass, thickness: (m.thickness ?? 0) * scale * images.meanOf(m.thicknessMap)[1] };
    });
}
