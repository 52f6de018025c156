// Depth probes of blocks around which something has moved, made anew.
// twin: src/gl/moved_texels.cpp.
import { createFramebuffer, createTexture2D } from './gl.js';
import { batchCorner, batchSize, batchTarget } from './texel_batch.js';
import { kBlockSize } from './texel_points.js';

const kTilesOfBlock = kBlockSize / 8,
    kProbeCells = 16;
const kTreeUnits = 4,
    kTexelPointUnits = 4;
// Texels of a block in the tables: of levels, and of tile patches.
const kLevels = [2 * kTilesOfBlock, 4 * kTilesOfBlock],
    kPatches = [2 * kTilesOfBlock, kTilesOfBlock];

export class ProbePass {
    // `pass`: a LightUpdatePass, which binds the points of the texels.
    constructor(pass) {
        const { gl } = pass,
            side = batchTarget(1);
        Object.assign(this, { gl, pass, stale: new Uint8Array(pass.blocks.length) });
        const cells = kTilesOfBlock * kProbeCells * side;
        this.codes = createTexture2D(gl, gl.R8UI, cells, cells);
        [this.levels, this.patches] = [kLevels, kPatches].map(([width, height]) =>
            createTexture2D(gl, gl.RGBA32UI, width * side, height * side),
        );
        this.targets = [this.codes, this.levels, this.patches].map((of) => createFramebuffer(gl, [of]));
    }

    // Something has moved.
    noteMotion() {
        this.stale.fill(1);
    }

    // Those of the batch's blocks that are stale. Not in a block's first turn, so that while something moves on and on no
    // time is spent on them. `scene`: a RayScene, as it is now.
    update(scene, batch) {
        const part = batch.part(({ block, rounds }) => this.stale[block] === 1 && rounds > 0);
        if (part.blocks.length === 0) return;
        const { pass } = this,
            { atlas, probes } = pass.passes;
        this.trace(scene, part);
        this.pack(part, pass.programs.packProbes, { target: this.targets[1], size: kLevels, to: probes });
        this.pack(part, pass.programs.packRanges, { target: this.targets[2], size: kPatches, to: atlas.tilePatches });
        part.blocks.forEach(({ block }) => {
            this.stale[block] = 0;
        });
    }

    trace(scene, part) {
        const { gl, pass } = this,
            { traceProbes: program } = pass.programs,
            { unitMeters } = pass.passes.bake.atlas;
        program.use();
        scene.bindTrees(program, 0);
        pass.bindTexelPoints(program, kTreeUnits);
        program.bind('tilePatches', kTreeUnits + kTexelPointUnits, gl.TEXTURE_2D, pass.passes.atlas.tilePatches);
        program.set('unitMeters', unitMeters);
        program.set('originUnitMeters', unitMeters);
        part.set(program, () => 0);
        pass.draw(this.targets[0], batchSize(part.blocks.length, kTilesOfBlock * kProbeCells));
    }

    // Draws `size` texels a block, and copies them to their places in the table `to`.
    pack(part, program, { target, size, to }) {
        const { gl, pass } = this,
            count = part.blocks.length;
        program.use();
        program.bind('distanceCodes', 0, gl.TEXTURE_2D, this.codes);
        if (to === pass.passes.atlas.tilePatches) program.bind('tilePatches', 1, gl.TEXTURE_2D, to);
        part.set(program, () => 0);
        pass.draw(target, [batchSize(count, size[0])[0], batchSize(count, size[1])[1]]);
        gl.readBuffer(gl.COLOR_ATTACHMENT0);
        gl.bindTexture(gl.TEXTURE_2D, to);
        part.blocks.forEach(({ block }, i) => {
            const rect = pass.blocks[block],
                scaled = (texels) => texels.map((x, axis) => (x / kBlockSize) * size[axis]),
                from = [0, 1].map((axis) => batchCorner(i, size[axis])[axis]);
            gl.copyTexSubImage2D(gl.TEXTURE_2D, 0, ...scaled(rect.origin), ...from, ...scaled(rect.size));
        });
    }

    dispose() {
        const { gl, codes, levels, patches, targets } = this;
        for (const texture of [codes, levels, patches]) gl.deleteTexture(texture);
        targets.forEach((framebuffer) => gl.deleteFramebuffer(framebuffer));
    }
}
