// The guides of blocks follow the light that their PHATexels meet.
// twin: src/gl/guide_pass.cpp.
import { createFramebuffer, createTexture2D } from './gl.js';
import { guideSumsOf } from './light_tables.js';
import { kTableSide, kTablesWide, uploadGuideTables } from './tables.js';
import { batchCorner, batchSize, batchTarget } from './texel_batch.js';

export class GuidePass {
    // `passes`: whose guides are shown; `programs`: LightPrograms.all.
    constructor(passes, programs) {
        const { gl, lookup } = passes,
            side = batchTarget(kTableSide),
            unknown = new Float32Array(2 * kTableSide ** 2),
            texture = (format) => createTexture2D(gl, format, side, side);
        Object.assign(this, { gl, passes, programs });
        this.sums = uploadGuideTables(gl, gl.R32UI, lookup.guides, guideSumsOf);
        this.lastCells = uploadGuideTables(gl, gl.RG32F, lookup.guides, () => unknown);
        [this.cells, this.newSums, this.inverseCdfs] = [gl.RG32F, gl.R32UI, gl.RGBA8].map(texture);
        this.cellsTarget = createFramebuffer(gl, [this.cells]);
        this.tablesTarget = createFramebuffer(gl, [this.newSums, this.inverseCdfs]);
    }

    // What was drawn for the blocks' guides, attachment `from` of a target, to their places in a table.
    copy({ blocks }, target, from, to, firstGuide) {
        const { gl } = this;
        gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
        gl.readBuffer(gl.COLOR_ATTACHMENT0 + from);
        gl.bindTexture(gl.TEXTURE_2D, to);
        blocks.forEach(({ block }, i) => {
            const guide = firstGuide + block,
                place = [guide % kTablesWide, Math.floor(guide / kTablesWide)].map((at) => kTableSide * at);
            gl.copyTexSubImage2D(gl.TEXTURE_2D, 0, ...place, ...batchCorner(i, kTableSide), kTableSide, kTableSide);
        });
    }

    // Makes the guides from the PHATexels, which are drawn by them from now on. `source`: of LightUpdatePass; `draw(target,
    // size)` draws with the program in use. pre: the source has a guide for each block.
    follow(batch, { firstLayer, firstGuide }, draw) {
        const { gl, passes } = this,
            { gather, tabulate } = this.programs,
            size = batchSize(batch.blocks.length, kTableSide);
        gather.use();
        gather.bind('phatexels', 0, gl.TEXTURE_2D_ARRAY, passes.phatexels);
        gather.bind('guideSums', 1, gl.TEXTURE_2D, this.sums);
        gather.bind('lastCells', 2, gl.TEXTURE_2D, this.lastCells);
        gather.bind('splitSumTable', 3, gl.TEXTURE_2D, passes.splitSum);
        gather.set('unitMeters', passes.bake.atlas.unitMeters);
        gather.set('layer', firstLayer);
        gather.set('firstGuide', firstGuide);
        batch.set(gather, ({ block }) => passes.lookup.layers[firstLayer].scrambles[block]);
        draw(this.cellsTarget, size);
        this.copy(batch, this.cellsTarget, 0, this.lastCells, firstGuide);
        tabulate.use();
        tabulate.bind('cells', 0, gl.TEXTURE_2D, this.cells);
        draw(this.tablesTarget, size);
        this.copy(batch, this.tablesTarget, 0, this.sums, firstGuide);
    }

    // Shows them to whoever reads PHATexels. pre: the blocks' first layer is drawn by them.
    show(batch, { firstGuide }) {
        this.copy(batch, this.tablesTarget, 1, this.passes.inverseCdfs, firstGuide);
    }

    dispose() {
        const { gl, sums, lastCells, cells, newSums, inverseCdfs } = this;
        for (const texture of [sums, lastCells, cells, newSums, inverseCdfs]) gl.deleteTexture(texture);
        for (const framebuffer of [this.cellsTarget, this.tablesTarget]) gl.deleteFramebuffer(framebuffer);
    }
}
