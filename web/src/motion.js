// Nodes of a room that its page moves: where their surfaces, texels and tiles are.
// twin: moveScene in src/gl/scene_upload.cpp, moveTexelPoints in src/gl/texel_points.cpp, moveChart in
// src/core/dynamic/dynamic_scene.cpp.
import { Matrix3, Matrix4, Vector3 } from 'three';
import { prepareUploads } from './fixed.js';
import { movedTile } from './tile_patch.js';
import { kVertexWords } from './surfaces.js';

// What rounding changes of a matrix, over its elements, is no motion.
const kRounding = 1e-9;

function isSame(a, b) {
    return a.elements.every((x, i) => Math.abs(x - b.elements[i]) <= kRounding * (1 + Math.abs(x)));
}

export class Motion {
    // `surfaces`: as gatherSurfaces returns them, of the room at rest.
    constructor(surfaces, atlas) {
        this.rest = surfaces;
        this.atlas = atlas;
        this.surfaces = surfaces; // where they are now
        this.revision = 0; // counts motions
        // Of each surface, in the space of the room: where it was last, how it has moved since it was baked (null: not at all),
        // and the revision of its last motion.
        this.places = surfaces.drawRanges.map(({ rootFromMesh }) => rootFromMesh);
        this.motions = this.places.map(() => null);
        this.revisions = this.places.map(() => 0);
    }

    // A box around a surface where it is, or was at rest.
    boundsOf(surface, { vertices } = this.surfaces) {
        const [first, end] = this.wordsOf(surface),
            floats = new Float32Array(vertices.buffer),
            box = { low: [0, 0, 0].fill(Infinity), high: [0, 0, 0].fill(-Infinity) };
        for (let at = first; at < end; at += kVertexWords)
            for (let axis = 0; axis < 3; ++axis) {
                box.low[axis] = Math.min(box.low[axis], floats[at + axis]);
                box.high[axis] = Math.max(box.high[axis], floats[at + axis]);
            }
        return box;
    }

    // Looks where the surfaces are. Returns whether any has moved. pre: world matrices are up to date.
    update(root) {
        const rootFromWorld = new Matrix4().copy(root.matrixWorld).invert(),
            before = this.revision;
        this.rest.drawRanges.forEach(({ mesh, rootFromMesh: rest }, i) => {
            const now = new Matrix4().multiplyMatrices(rootFromWorld, mesh.matrixWorld);
            if (isSame(now, this.places[i])) return;
            if (this.revision === before) ++this.revision;
            this.places[i] = now;
            this.revisions[i] = this.revision;
            this.motions[i] = isSame(now, rest) ? null : new Matrix4().multiplyMatrices(now, rest.clone().invert());
            this.moveCorners(i);
        });
        return this.revision !== before;
    }

    // Words of a surface in its vertices.
    wordsOf(surface) {
        const { firstVertex } = this.rest.drawRanges[surface],
            next = this.rest.drawRanges[surface + 1]?.firstVertex ?? this.rest.vertices.length / kVertexWords;
        return [kVertexWords * firstVertex, kVertexWords * next];
    }

    moveCorners(surface) {
        const [first, end] = this.wordsOf(surface),
            motion = this.motions[surface];
        if (this.surfaces === this.rest) this.surfaces = { ...this.rest, vertices: this.rest.vertices.slice() };
        const { vertices } = this.surfaces,
            floats = new Float32Array(vertices.buffer),
            vector = new Vector3();
        vertices.set(this.rest.vertices.subarray(first, end), first);
        if (!motion) return;
        const normalMatrix = new Matrix3().getNormalMatrix(motion);
        for (let at = first; at < end; at += kVertexWords) {
            vector.fromArray(floats, at).applyMatrix4(motion).toArray(floats, at);
            vector.fromArray(floats, at + 3).applyNormalMatrix(normalMatrix).toArray(floats, at + 3);
            vector.fromArray(floats, at + 6).transformDirection(motion).toArray(floats, at + 6);
        }
    }

    // Three rows a chart of the matrix that takes its texels to where they are.
    chartPoses() {
        const rows = this.atlas.charts.flatMap(({ surface }) => {
            const m = (this.motions[surface] ?? new Matrix4()).elements;
            return [0, 1, 2].flatMap((row) => [m[row], m[4 + row], m[8 + row], m[12 + row]]);
        });
        return Float32Array.from(rows);
    }

    // TexelPoints.blocks where they are now.
    moveBlocks(blocks) {
        const moved = [...blocks];
        this.atlas.charts.forEach(({ surface, firstBlock, blocksWide, sizeTiles }) => {
            const motion = this.motions[surface];
            if (!motion) return;
            for (let i = firstBlock; i < firstBlock + blocksWide * Math.ceil(sizeTiles[1] / 4); ++i) {
                const { center, normal } = blocks[i];
                moved[i] = {
                    ...blocks[i],
                    center: new Vector3(...center).applyMatrix4(motion).toArray(),
                    normal: new Vector3(...normal).transformDirection(motion).toArray(),
                };
            }
        });
        return moved;
    }

    // Tile patches of a chart where they are now, eight words a tile.
    tilesOf({ surface, originTile: [left, top], sizeTiles: [width, height] }) {
        const { tilePatches } = this.atlas,
            tilesWide = this.atlas.width / 8,
            motion = this.motions[surface] ?? new Matrix4(),
            words = new Uint32Array(8 * width * height);
        for (let i = 0; i < width * height; ++i) {
            const tile = (top + Math.floor(i / width)) * tilesWide + left + (i % width);
            words.set(movedTile(tilePatches.subarray(8 * tile, 8 * tile + 8), motion), 8 * i);
        }
        return words;
    }
}

// What one renderer's passes have of it on the GPU.
export class MovedSurfaces {
    constructor(passes, motion) {
        Object.assign(this, { passes, motion, shown: 0, posed: 0 });
    }

    // What is drawn, and looked up. Leaves WebGL's state to the caller.
    show() {
        const { motion, shown, passes } = this,
            { gl } = passes;
        if (shown === motion.revision) return;
        this.shown = motion.revision;
        prepareUploads(gl);
        const isNew = (surface) => motion.revisions[surface] > shown;
        gl.bindVertexArray(null);
        gl.bindBuffer(gl.ARRAY_BUFFER, passes.vertices.buffers[0]);
        motion.revisions.forEach((_, surface) => {
            if (!isNew(surface)) return;
            const [first, end] = motion.wordsOf(surface);
            gl.bufferSubData(gl.ARRAY_BUFFER, 4 * first, motion.surfaces.vertices, first, end - first);
        });
        gl.bindTexture(gl.TEXTURE_2D, passes.atlas.tilePatches);
        for (const chart of motion.atlas.charts) {
            if (!isNew(chart.surface)) continue;
            const [left, top] = chart.originTile,
                [width, height] = chart.sizeTiles,
                kind = [gl.RGBA_INTEGER, gl.UNSIGNED_INT];
            gl.texSubImage2D(gl.TEXTURE_2D, 0, 2 * left, top, 2 * width, height, ...kind, motion.tilesOf(chart));
        }
    }

    // What rays of `scene`, the passes' own, meet.
    pose(scene) {
        const { motion, posed } = this;
        if (posed === motion.revision) return;
        this.posed = motion.revision;
        scene.tracing.poseScene(scene, motion, posed);
    }
}
