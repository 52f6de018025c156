// Rays through the trees of a room on the CPU, without the instances of moved nodes.
// twin: shaders/lib/bvh.glsl, src/core/bvh/bvh_rays.cpp
import { kNodeWords } from './trees.js';

const kTriangleWords = 8;
const kCornerShift = 4; // the upper 28 bits of a word are a coordinate, in sixteenths of a step
const kExponentBits = 0x7f800000;
const kBoxRounding = 1e-6;

const word = new Uint32Array(1),
    asFloat = new Float32Array(word.buffer);
function floatOf(bits) {
    word[0] = bits;
    return asFloat[0];
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

export class TreeRays {
    // `trees`: as readTrees returns them.
    constructor({ nodes, root, triangles, gridStep }) {
        Object.assign(this, { nodes, root, triangles, sixteenth: gridStep.map((step) => step / 16) });
    }

    // The corners of a triangle in the order of the leaves.
    corners(index) {
        const { triangles, sixteenth } = this,
            at = kTriangleWords * index;
        let last = 0;
        for (let i = 0; i < 7; ++i) last |= (triangles[at + i] & 15) << (kCornerShift * (i + 1));
        const coordinate = (i) => ((i < 8 ? triangles[at + i] & ~15 : last) | 0) * sixteenth[i % 3];
        return [0, 3, 6].map((first) => [coordinate(first), coordinate(first + 1), coordinate(first + 2)]);
    }

    // Distance to a triangle along the ray, if it is below `nearest`.
    meet(index, origin, direction, nearest) {
        const [a, b, c] = this.corners(index).map((corner) => minus(corner, origin)),
            edges = [cross(c, a), cross(a, b), cross(b, c)].map((normal) => dot(normal, direction));
        if (Math.min(...edges) < 0 && Math.max(...edges) > 0) return nearest;
        const normal = cross(minus(b, a), minus(c, a)),
            along = dot(normal, direction),
            distance = dot(a, normal) / along;
        return distance > 0 && distance < nearest ? distance : nearest;
    }

    // Where the ray enters a child's box; infinite if it doesn't before `nearest`.
    enter(node, child, origin, inverse, nearest) {
        const { nodes } = this,
            at = kNodeWords * node,
            exponents = nodes[at + 3];
        let from = 0,
            to = nearest;
        for (let axis = 0; axis < 3; ++axis) {
            const low = floatOf(nodes[at + axis]),
                scale = floatOf((exponents << (23 - 8 * axis)) & kExponentBits),
                side = (offset) => low + ((nodes[at + offset + axis] >>> (8 * child)) & 255) * scale - origin[axis];
            const [near, far] = [side(4) * inverse[axis], side(7) * inverse[axis]];
            if (side(4) > side(7)) return Infinity; // there is no such child
            from = Math.max(from, Math.min(near, far));
            to = Math.min(to, Math.max(near, far));
        }
        return from <= to * (1 + kBoxRounding) + Number.EPSILON ? from : Infinity;
    }

    // Distance to the nearest surface; `far` if there is none before. Arrays of three numbers.
    distance(origin, direction, far) {
        const { nodes } = this,
            inverse = direction.map((d) => 1 / (Math.abs(d) > 1e-20 ? d : 1e-20)),
            stack = [[0, this.root]];
        let nearest = far;
        while (stack.length > 0) {
            const [entry, node] = stack.pop();
            if (entry >= nearest) continue;
            const at = kNodeWords * node,
                innerCount = nodes[at + 3] >>> 24,
                first = nodes[at + 10] >>> 8,
                below = [];
            let triangle = nodes[at + 11];
            for (let child = 0; child < 4; ++child) {
                const isInner = child < innerCount,
                    count = isInner ? 0 : 1 + ((nodes[at + 10] >>> (2 * child)) & 3),
                    entered = this.enter(node, child, origin, inverse, nearest);
                if (entered < Infinity && isInner) below.push([entered, first + child]);
                else if (entered < Infinity)
                    for (let i = 0; i < count; ++i) nearest = this.meet(triangle + i, origin, direction, nearest);
                triangle += count;
            }
            stack.push(...below.sort((a, b) => b[0] - a[0]));
        }
        return nearest;
    }
}
