// The trees of a baked file, as shaders trace rays through them (docs/format.md, `bvh`).
// twin: src/core/bvh/restore_bvh.cpp; src/core/bvh/posed_bvh.cpp, for a scene at rest; src/core/bvh/bvh_node.cpp and
// src/core/bvh/bvh_triangle.cpp.
import { fail, readPayload } from './file.js';
import { kVertexWords } from './surfaces.js';

export const kNodeWords = 12;
const kTriangleWords = 8,
    kWidth = 4;
const kCoordinateBits = 28,
    kMaxCoordinate = 2 ** 40,
    kMinStepExponent = -100;
// Words of a traversal's stack: of all, and of those that a group may need. twin: src/core/bvh/scene_bvh.h.
const kStackWords = 32,
    kGroupStackWords = 23;

// The triangles of each node that are opaque, by its number, then of each that are masked or blended, with the surface
// that each triangle must be of.
function groupsOf({ json }, description, drawRanges) {
    const groups = new Map();
    description.surfaces.forEach(({ node, primitive }, surface) => {
        const count = drawRanges[surface].count / 3;
        if (count === 0) return;
        const { material } = json.meshes[json.nodes[node].mesh].primitives[primitive];
        const transparent = (json.materials?.[material]?.alphaMode ?? 'OPAQUE') !== 'OPAQUE';
        const key = `${transparent} ${node}`;
        if (!groups.has(key)) groups.set(key, { node, transparent, triangleCount: 0, surfaces: new Set() });
        const group = groups.get(key);
        group.triangleCount += count;
        group.surfaces.add(surface);
    });
    return [...groups.values()].sort((a, b) => a.transparent - b.transparent || a.node - b.node);
}

// The surface of each triangle.
function surfaceOfTriangles(drawRanges) {
    const surfaces = new Uint32Array(drawRanges.reduce((sum, { count }) => sum + count / 3, 0));
    drawRanges.forEach(({ first, count }, i) => surfaces.fill(i, first / 3, (first + count) / 3));
    return surfaces;
}

// Steps of the grid of all corners, metres.
export function gridOver(floats) {
    const largest = [0, 0, 0];
    for (let at = 0; at < floats.length; at += kVertexWords)
        for (let axis = 0; axis < 3; ++axis)
            largest[axis] = Math.max(largest[axis], Math.abs(floats[at + axis]));
    return largest.map((x) => {
        const most = Math.min(x, kMaxCoordinate);
        let exponent = most > 0 ? Math.floor(Math.log2(most)) : 0;
        while (most >= 2 ** exponent) ++exponent;
        while (most > 0 && most < 2 ** (exponent - 1)) --exponent;
        return 2 ** Math.max(exponent - (kCoordinateBits - 1), kMinStepExponent);
    });
}

// A coordinate in the upper bits of a word.
function shifted(coordinate, step) {
    const clamped = Math.min(Math.max(coordinate, -kMaxCoordinate), kMaxCoordinate);
    return (Math.round(clamped / step) << (32 - kCoordinateBits)) >>> 0;
}

// Writes a triangle of nine coordinates to `words` from `at` on.
function packTriangle(words, at, corners, step) {
    for (let i = 0; i < kTriangleWords; ++i) words[at + i] = shifted(corners[i], step[i % 3]);
    const last = shifted(corners[8], step[2]) >>> (32 - kCoordinateBits);
    for (let i = 0; i < 7; ++i) words[at + i] |= (last >>> (4 * i)) & 15;
}

// All triangles in the order of the leaves; adds to each group its first triangle and its bounds.
function packTriangles({ vertices, indices }, order, groups, step) {
    const floats = new Float32Array(vertices.buffer),
        words = new Uint32Array(kTriangleWords * order.length),
        corners = new Float32Array(9);
    let i = 0;
    for (const group of groups) {
        const bounds = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
        Object.assign(group, { firstTriangle: i, bounds });
        for (const end = i + group.triangleCount; i < end; ++i) {
            for (let c = 0; c < 9; ++c) {
                const axis = c % 3,
                    vertex = indices[3 * order[i] + (c - axis) / 3];
                corners[c] = floats[kVertexWords * vertex + axis];
                const onGrid = Math.fround(Math.round(corners[c] / step[axis]) * step[axis]);
                bounds.low[axis] = Math.min(bounds.low[axis], onGrid);
                bounds.high[axis] = Math.max(bounds.high[axis], onGrid);
            }
            packTriangle(words, kTriangleWords * i, corners, step);
        }
    }
    return words;
}

// Walks through the tree at `root`. Returns the number of the node that follows its last one. Children come after their
// parents, so that no walk goes in circles.
function walk(nodes, nodeCount, root) {
    const pending = [[root, 0]];
    let last = root;
    for (let visits = 0; pending.length > 0; ++visits) {
        const [node, above] = pending.pop(),
            at = kNodeWords * node,
            inner = nodes[at + 3] >>> 24,
            first = nodes[at + 10] >>> 8,
            words = above + (inner > 1 ? 1 : 0);
        if (node >= nodeCount || visits > nodeCount || inner > kWidth || words > kGroupStackWords)
            fail('the trees for rays are damaged');
        if (inner > 0 && first <= node) fail('the trees for rays are damaged');
        for (let child = 0; child < inner; ++child) pending.push([first + child, words]);
        last = Math.max(last, node);
    }
    return last + 1;
}

const kExponentBias = 127,
    kMinExponent = -100;
const floatWord = new Float32Array(1),
    bitsOfFloat = new Uint32Array(floatWord.buffer);

// A node of which all children are inner ones. Boxes are rounded outwards.
export function packNode(nodes, at, boxes, firstInner) {
    nodes.fill(0, at, at + kNodeWords);
    let exponents = 0;
    for (let axis = 0; axis < 3; ++axis) {
        const low = Math.min(...boxes.map((box) => box.low[axis])),
            extent = Math.max(...boxes.map((box) => box.high[axis])) - low;
        let exponent = extent > 0 ? Math.max(kMinExponent, Math.floor(Math.log2(extent / 255))) : kMinExponent;
        while (255 * 2 ** exponent < extent) ++exponent;
        floatWord[0] = low;
        nodes[at + axis] = bitsOfFloat[0];
        exponents |= (exponent + kExponentBias) << (8 * axis);
        for (let child = 0; child < kWidth; ++child) {
            const box = boxes[child],
                byte = (x) => Math.min(Math.max(x, 0), 255);
            // That of a child that is not there is turned inside out.
            const first = box ? byte(Math.floor((box.low[axis] - low) / 2 ** exponent)) : 255,
                end = box ? byte(Math.ceil((box.high[axis] - low) / 2 ** exponent)) : 0;
            nodes[at + 4 + axis] |= first << (8 * child);
            nodes[at + 7 + axis] |= end << (8 * child);
        }
    }
    nodes[at + 3] = (exponents | (boxes.length << 24)) >>> 0;
    nodes[at + 10] = firstInner << 8;
}

function boundsOf(groups) {
    const join = (of, side) => [0, 1, 2].map((axis) => of(...groups.map(({ bounds }) => bounds[side][axis])));
    return { low: join(Math.min, 'low'), high: join(Math.max, 'high') };
}

// In the middle of the axis along which they are farthest apart.
function halves(groups) {
    const { low, high } = boundsOf(groups),
        extents = low.map((x, i) => high[i] - x),
        axis = extents.indexOf(Math.max(...extents)),
        middle = ({ bounds }) => bounds.low[axis] + bounds.high[axis];
    const sorted = [...groups].sort((a, b) => middle(a) - middle(b)),
        half = Math.ceil(groups.length / 2);
    return [sorted.slice(0, half), sorted.slice(half)];
}

// A balanced tree over the groups, whose nodes follow those that there are. Each group is there by its `head`: the words of
// its root, or of an instance.
// Returns all nodes and the number of the root.
export function joinGroups(nodes, groups) {
    const nodeCount = nodes.length / kNodeWords,
        all = new Uint32Array(kNodeWords * (nodeCount + 2 * Math.max(groups.length, 1)));
    all.set(nodes);
    let end = nodeCount + 1;
    const place = (at, below) => {
        if (below.length === 1) {
            all.set(below[0].head, kNodeWords * at);
            return;
        }
        const parts = halves(below).flatMap((half) => (half.length > 1 ? halves(half) : [half])),
            first = end;
        end += parts.length;
        packNode(all, kNodeWords * at, parts.map(boundsOf), first);
        parts.forEach((part, i) => place(first + i, part));
    };
    if (groups.length > 0) place(nodeCount, groups);
    else packNode(all, kNodeWords * nodeCount, [], 0);
    return { nodes: all.subarray(0, kNodeWords * end), root: nodeCount };
}

// What shaders/lib/bvh.glsl reads: nodes, triangles in the order of the leaves, the first of which are opaque.
// `surfaces`: as gatherSurfaces returns them.
export async function readTrees(parser, description, surfaces) {
    const { bvh } = description,
        triangleCount = surfaces.indices.length / 3;
    const [stored, order] = await Promise.all([
        readPayload(parser, bvh.nodes, Uint32Array, kNodeWords * bvh.nodeCount, 'a list of nodes'),
        readPayload(parser, bvh.order, Uint32Array, triangleCount, 'the order of the triangles'),
    ]);
    const groups = groupsOf(parser, description, surfaces.drawRanges),
        surfaceOf = surfaceOfTriangles(surfaces.drawRanges);
    if (groups.length > kWidth ** (kStackWords - kGroupStackWords)) fail('there are too many nodes for rays');
    let next = 0;
    for (const group of groups) {
        for (let i = 0; i < group.triangleCount; ++i)
            if (!group.surfaces.has(surfaceOf[order[next + i]])) fail('the trees for rays are of other triangles');
        next += group.triangleCount;
    }
    const step = gridOver(new Float32Array(surfaces.vertices.buffer));
    const triangles = packTriangles(surfaces, order, groups, step);
    let root = 0;
    for (const group of groups) {
        Object.assign(group, { root, head: stored.subarray(kNodeWords * root, kNodeWords * (root + 1)) });
        root = walk(stored, bvh.nodeCount, root);
    }
    const opaque = groups.filter(({ transparent }) => !transparent);
    return {
        ...joinGroups(stored, groups),
        groups,
        triangles,
        order,
        surfaceOf,
        gridStep: step,
        firstTransparent: opaque.reduce((sum, group) => sum + group.triangleCount, 0),
    };
}
