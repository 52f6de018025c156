// Meshes that share their geometry with surfaces of a bake: clones of a room or of its parts, and instances. They
// show the light that their surface has in the bake, as if all of the room had moved along.
import { Matrix4 } from 'three';

const kNoMatrices = [null];

// The matrices of an InstancedMesh, or one that is none.
function instancesOf(mesh) {
    if (!mesh.isInstancedMesh) return kNoMatrices;
    return Array.from({ length: mesh.count }, (_, i) => {
        const matrix = new Matrix4();
        mesh.getMatrixAt(i, matrix);
        return matrix;
    });
}

// Calls `found(mesh, range, worldFromRoot)` for each copy in a scene of a surface of `drawRanges`, of which `range` is
// the number.
export function findCopies(scene, drawRanges, found) {
    const own = new Set(drawRanges.map(({ mesh }) => mesh)),
        byGeometry = new Map();
    drawRanges.forEach(({ mesh }, i) => {
        const { geometry } = mesh;
        byGeometry.set(geometry, [...(byGeometry.get(geometry) ?? []), i]);
    });
    scene.traverseVisible((mesh) => {
        const ranges = mesh.isMesh && !own.has(mesh) && byGeometry.get(mesh.geometry);
        if (!ranges) return;
        // Of nodes that share a geometry, clones keep the names.
        const range = ranges.find((i) => drawRanges[i].mesh.name === mesh.name) ?? ranges[0],
            meshFromRoot = drawRanges[range].rootFromMesh.clone().invert();
        for (const matrix of instancesOf(mesh)) {
            const worldFromRoot = mesh.matrixWorld.clone();
            if (matrix) worldFromRoot.multiply(matrix);
            found(mesh, range, worldFromRoot.multiply(meshFromRoot));
        }
    });
}
