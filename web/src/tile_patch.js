// Where the texels of a tile are, as shaders read it.
// twin: shaders/lib/tile_patch.glsl, src/core/phatexel/tile_patch.cpp; the frame: shaders/lib/frame.glsl; the normal:
// packOctahedral24 in src/core/phatexel/phatexture.cpp.
import { Vector3 } from 'three';
import { octahedral } from './file.js';

const kMaxCode = 4095;
const kAngles = 4096;

export function packOctahedral24(direction) {
    const [x, y] = octahedral(direction).map((t) => Math.floor(Math.min(Math.max(0.5 * t + 0.5, 0), 1) * kMaxCode + 0.5));
    return x | (y << 12);
}

export function unpackOctahedral24(bits) {
    const [x, y] = [bits & kMaxCode, (bits >> 12) & kMaxCode].map((code) => (2 * code) / kMaxCode - 1),
        z = 1 - Math.abs(x) - Math.abs(y),
        fold = (a, b) => (1 - Math.abs(b)) * (a >= 0 ? 1 : -1);
    return new Vector3(...(z < 0 ? [fold(x, y), fold(y, x), z] : [x, y, z])).normalize();
}

// [tangent, bitangent]
function frameFromNormal({ x, y, z }) {
    const side = z < 0 ? -1 : 1,
        a = -1 / (side + z),
        b = x * y * a;
    return [new Vector3(1 + side * x * x * a, side * b, -side * x), new Vector3(b, side + y * y * a, -y)];
}

// The eight words of a tile after a rigid motion.
export function movedTile(words, motion) {
    const moved = words.slice(),
        center = new Vector3(...new Float32Array(moved.buffer, 0, 3)).applyMatrix4(motion),
        normal = unpackOctahedral24(words[4] & 0xffffff),
        [u, v] = frameFromNormal(normal),
        angle = ((words[5] & 0xfff) * 2 * Math.PI) / kAngles,
        tangent = u.multiplyScalar(Math.cos(angle)).addScaledVector(v, Math.sin(angle));
    center.toArray(new Float32Array(moved.buffer));
    const code = packOctahedral24(normal.transformDirection(motion).toArray()),
        base = frameFromNormal(unpackOctahedral24(code)),
        turned = tangent.transformDirection(motion),
        newAngle = Math.atan2(turned.dot(base[1]), turned.dot(base[0]));
    moved[4] = ((words[4] & 0xff000000) | code) >>> 0;
    moved[5] = ((words[5] & ~0xfff) | (Math.round((newAngle * kAngles) / (2 * Math.PI)) & 0xfff)) >>> 0;
    return moved;
}
