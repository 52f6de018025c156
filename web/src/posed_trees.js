// The small tree over a room's groups of triangles, where a page has moved them, and what else rays read of them.
// twin: src/core/bvh/posed_bvh.cpp, packInstance and packMatrix in src/core/bvh/bvh_node.cpp.
import { Vector3 } from 'three';
import { surfaceRows, kTriangleWords } from './hit_tables.js';
import { createTable } from './tables.js';
import { joinGroups, kNodeWords } from './trees.js';

const kInstance = 255;
// twin: kMotionRounding in src/core/bvh/posed_bvh.cpp
const kMotionRounding = 16 * 2 ** -24;

function movedBounds({ low, high }, motion) {
    const moved = { low: [0, 0, 0].fill(Infinity), high: [0, 0, 0].fill(-Infinity) },
        m = motion.elements;
    for (let corner = 0; corner < 8; ++corner) {
        const at = new Vector3(...low.map((x, axis) => ((corner >> axis) & 1 ? high[axis] : x)))
            .applyMatrix4(motion)
            .toArray();
        moved.low = moved.low.map((x, axis) => Math.min(x, at[axis]));
        moved.high = moved.high.map((x, axis) => Math.max(x, at[axis]));
    }
    const largest = low.map((x, axis) => Math.max(Math.abs(x), Math.abs(high[axis])));
    for (let axis = 0; axis < 3; ++axis) {
        const terms = largest.reduce((sum, x, i) => sum + Math.abs(m[4 * i + axis]) * x, Math.abs(m[12 + axis]));
        moved.low[axis] -= kMotionRounding * terms;
        moved.high[axis] += kMotionRounding * terms;
    }
    return moved;
}

// The rows of the matrix that takes rays into the space of a group at rest.
function packMatrix(motion) {
    const m = motion.clone().invert().elements,
        rows = [0, 1, 2].flatMap((row) => [m[row], m[4 + row], m[8 + row], m[12 + row]]);
    return new Uint32Array(Float32Array.from(rows).buffer);
}

// { nodes, root, first }: all nodes, of which those from `first` on depend on the motions. `trees`: of readTrees; `motions`:
// of each surface, or null. A node for the matrix of each group follows the nodes at rest, then the tree over the groups.
// What a matrix makes flat is left out.
export function poseTrees(trees, motions) {
    const { groups } = trees,
        first = trees.root, // nodes at rest end where the tree over the groups began
        nodes = new Uint32Array(kNodeWords * (first + groups.length));
    nodes.set(trees.nodes.subarray(0, kNodeWords * first));
    const posed = groups.map((group, i) => {
        const motion = motions[group.surfaces.values().next().value];
        if (!motion) return group;
        const determinant = motion.determinant(),
            head = new Uint32Array(kNodeWords);
        if (determinant === 0) return null;
        nodes.set(packMatrix(motion), kNodeWords * (first + i));
        head.set([group.root, determinant < 0 ? 1 : 0, first + i, (kInstance << 24) >>> 0]);
        return { ...group, head, bounds: movedBounds(group.bounds, motion) };
    });
    return { ...joinGroups(nodes, posed.filter(Boolean)), first };
}

// Lets the rays of `scene`, a RayScene, meet what has moved after `since`. Leaves WebGL's state to the caller.
export function poseScene(scene, motion, since) {
    const { gl, trees } = scene,
        { nodes, root, first } = poseTrees(trees, motion.motions),
        most = kNodeWords * (first + 3 * trees.groups.length + 1);
    if (!scene.capacity) {
        const all = new Uint32Array(most);
        all.set(nodes);
        gl.deleteTexture(scene.nodes);
        scene.nodes = createTable(gl, gl.RGBA32UI, all);
        scene.capacity = most;
    } else scene.write(scene.nodes, 3 * first, nodes.subarray(kNodeWords * first));
    scene.root = root;
    scene.surfaces = motion.surfaces;
    const { emitters, trianglesOf } = surfaceRows(scene);
    for (const { firstTriangle, triangleCount, surfaces } of trees.groups) {
        if (![...surfaces].some((surface) => motion.revisions[surface] > since)) continue;
        const at = scene.hits.firstTriangle + (kTriangleWords / 4) * firstTriangle;
        scene.write(scene.hits.table, at, trianglesOf(firstTriangle, triangleCount));
    }
    scene.write(scene.hits.table, scene.hits.firstEmitter, emitters);
    ++scene.revision;
}
