// Ellipsoids that stand for meshes where they keep light from the room: contact shadows.
// twin: src/core/scene/occluders.cpp, of which each part is a mesh here.
import { Box3, Matrix3, Matrix4, Vector3 } from 'three';
import { isBlended } from './material.js';

// twin: kMaxOccluders in src/core/scene/occluders.h, shaders/lib/contact_shadow.glsl.
export const kMaxOccluders = 32;
const kMaxDivisions = 4;
// A triangle is divided as often along a side, at most, to be shared by the cells.
const kMaxSplits = 16;
const kRound = 3 / 16;
const kRowWords = 12;

function gridOver(positions, divisions) {
    const { min, max } = new Box3().setFromBufferAttribute(positions),
        extent = max.clone().sub(min).toArray(),
        side = Math.max(Math.min(...extent), Math.max(...extent) / divisions, 1e-30),
        count = extent.map((x) => Math.max(Math.floor(x / side + 0.5), 1)),
        size = extent.map((x, i) => Math.max(x / count[i], 1e-30)),
        low = min.toArray();
    const cellAt = (p) => {
        const [x, y, z] = p.map((v, i) => Math.min(Math.max(Math.floor((v - low[i]) / size[i]), 0), count[i] - 1));
        return (z * count[1] + y) * count[0] + x;
    };
    return { shortest: Math.min(...size), cellAt };
}

const emptyCell = () => ({ area: 0, weighted: new Vector3(), directions: [0, 0, 0, 0, 0, 0] });

// Adds a triangle's area, in small equal triangles, to the cells that it is in.
function share([a, b, c], grid, cells) {
    const ab = b.clone().sub(a),
        ac = c.clone().sub(a),
        longest = Math.max(ab.length(), ac.length(), b.distanceTo(c)),
        splits = Math.ceil((4 * longest) / Math.max(grid.shortest, 1e-6 * longest)),
        n = Math.min(Math.max(splits, 1), kMaxSplits),
        normal = new Vector3().crossVectors(ab, ac),
        area = (0.5 * normal.length()) / (n * n);
    if (!(area > 0)) return;
    const { x, y, z } = normal.normalize(),
        directions = [x * x, y * y, z * z, x * y, x * z, y * z].map((product) => area * product);
    const add = (i, j) => {
        const p = a.clone().addScaledVector(ab, i / (3 * n)).addScaledVector(ac, j / (3 * n)),
            cell = (cells[grid.cellAt(p.toArray())] ??= emptyCell());
        cell.area += area;
        cell.weighted.addScaledVector(p, area);
        directions.forEach((value, k) => (cell.directions[k] += value));
    };
    for (let i = 0; i < n; ++i)
        for (let j = 0; i + j < n; ++j) {
            add(3 * i + 1, 3 * j + 1);
            if (i + j + 1 < n) add(3 * i + 2, 3 * j + 2);
        }
}

// In the geometry's own space: { center, squaredShadow }, see Occluder in src/core/scene/occluders.h.
export function occludersOf({ attributes, index }, divisions) {
    const { position } = attributes,
        grid = gridOver(position, divisions),
        cells = [],
        corner = (i) => new Vector3().fromBufferAttribute(position, index ? index.getX(i) : i);
    for (let i = 0; i + 2 < (index ?? position).count; i += 3)
        share([corner(i), corner(i + 1), corner(i + 2)], grid, cells);
    return cells.filter(Boolean).map(({ area, weighted, directions }) => {
        const [xx, yy, zz, xy, xz, yz] = directions.map((value) => kRound * area * value);
        return {
            center: weighted.divideScalar(area),
            squaredShadow: new Matrix3().set(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        };
    });
}

// As an ellipsoid's: areas are vectors, which the matrix of the cofactors transforms.
function rowsOf({ center, squaredShadow }, pose) {
    const cofactors = new Matrix3().getNormalMatrix(pose).multiplyScalar(pose.determinant()),
        [xx, xy, xz, , yy, yz, , , zz] = cofactors
            .clone()
            .multiply(squaredShadow)
            .multiply(cofactors.clone().transpose())
            .elements;
    return [...center.clone().applyMatrix4(pose).toArray(), xx, yy, zz, xy, xz, yz, 0, 0, 0];
}

function isShown(object) {
    for (let o = object; o; o = o.parent) if (!o.visible) return false;
    return true;
}

const throwsShadow = (mesh) => !mesh.isInstancedMesh && !mesh.isBatchedMesh && ![mesh.material].flat().some(isBlended);

// What stands for some meshes, wherever these are.
export class Occluders {
    #ofMeshes = new Map(); // in their own space

    // As fine as there is room for.
    set(meshes) {
        const opaque = meshes.filter(throwsShadow);
        for (let divisions = kMaxDivisions; divisions > 0; --divisions) {
            this.#ofMeshes = new Map(opaque.map((mesh) => [mesh, occludersOf(mesh.geometry, divisions)]));
            if ([...this.#ofMeshes.values()].flat().length <= kMaxOccluders) return;
        }
    }

    // In the space of `root`, as the shader reads them: { count, rows }. Of too many meshes the first ones have any.
    in(root) {
        const rootFromWorld = new Matrix4().copy(root.matrixWorld).invert(),
            found = [];
        for (const [mesh, occluders] of this.#ofMeshes) {
            if (!isShown(mesh)) continue;
            const pose = new Matrix4().multiplyMatrices(rootFromWorld, mesh.matrixWorld);
            found.push(...occluders.map((occluder) => rowsOf(occluder, pose)));
        }
        const rows = new Float32Array(kRowWords * kMaxOccluders),
            kept = found.slice(0, kMaxOccluders);
        rows.set(kept.flat());
        return { count: kept.length, rows };
    }
}
