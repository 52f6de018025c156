// Which texels something covers that has moved.
// twin: src/gl/moved_texels.cpp.
import { createTexture2D } from './gl.js';

// How far what touches a texel may be from it, over the radius of its block. twin: kPressedTexels in
// src/core/atlas/texel_cover.h, of a texel, of which a block has 32 a side; texels at its rim are outside of its sphere.
const kTouchOverRadius = 0.1;
const kTreeUnits = 4,
    kTexelPointUnits = 4;

function meets({ low, high }, { center, radius }) {
    const reach = (1 + kTouchOverRadius) * radius,
        squared = center.reduce((sum, x, axis) => sum + Math.max(low[axis] - x, x - high[axis], 0) ** 2, 0);
    return squared <= reach * reach;
}

export class TexelCover {
    // `pass`: a LightUpdatePass; `points`: TexelPoints.
    constructor(pass, points) {
        Object.assign(this, { pass, points });
        this.revision = 0; // of the Motion
        this.bounds = []; // of surfaces that have moved, where they were then
        this.uncertain = new Uint8Array(points.blocks.length); // by block: whether it must be looked at again
    }

    // Texels near what has moved may be covered now, or not any more. `places`: Motion.moveBlocks.
    note(motion, places) {
        const { pass, points, revision } = this,
            { gl } = pass,
            { width, height, charts } = motion.atlas,
            isNew = (surface) => motion.revisions[surface] > revision;
        this.restNormals ??= createTexture2D(gl, gl.R32UI, width, height, points.normals);
        const boxes = motion.revisions.flatMap((_, surface) => {
            if (!isNew(surface)) return [];
            const both = [this.bounds[surface] ?? motion.boundsOf(surface, motion.rest), motion.boundsOf(surface)];
            this.bounds[surface] = both[1];
            return both;
        });
        charts.forEach(({ surface, firstBlock }, chart) => {
            const end = charts[chart + 1]?.firstBlock ?? places.length;
            for (let block = firstBlock; block < end; ++block)
                if (isNew(surface) || boxes.some((box) => meets(box, places[block]))) this.uncertain[block] = 1;
        });
        this.revision = motion.revision;
    }

    // Looks at those of the batch's blocks that are uncertain. `scene`: a RayScene, as it is now.
    update(scene, batch) {
        const { pass, uncertain } = this,
            { gl, normals, targets } = pass,
            { cover: program } = pass.programs,
            part = batch.part(({ block }) => uncertain[block] === 1);
        if (part.blocks.length === 0) return;
        program.use();
        scene.bindTrees(program, 0);
        pass.bindTexelPoints(program, kTreeUnits);
        program.bind('texelNormals', kTreeUnits + 1, gl.TEXTURE_2D, this.restNormals);
        scene.bindHits(program, kTreeUnits + kTexelPointUnits);
        program.set('originUnitMeters', pass.passes.bake.atlas.unitMeters);
        part.set(program, () => 0);
        pass.draw(targets.codes, part.size);
        part.copyWords(targets.codes, normals);
        part.blocks.forEach(({ block }) => {
            uncertain[block] = 0;
        });
    }

    dispose() {
        this.pass.gl.deleteTexture(this.restNormals ?? null);
    }
}
