// The bounds of the radiance around tiles, of PHATexels that are made anew.
// twin: src/gl/tile_bounds_pass.cpp.
import { createFramebuffer, createTexture2D } from './gl.js';

const kTileSize = 8;
const kUnbounded = 1e30;

export class TileBounds {
    // `pass`: a LightUpdatePass. Leaves WebGL's state to the caller.
    constructor(pass) {
        const { gl, passes } = pass,
            { width, height } = passes.bake.atlas;
        Object.assign(this, { gl, pass, size: [width / kTileSize, height / kTileSize], isKnown: true });
        const texture = () => createTexture2D(gl, gl.RGBA32F, ...this.size);
        [this.indirect, this.area] = [texture(), texture()]; // the brightest PHATexel of each tile
        this.brightestTarget = createFramebuffer(gl, [this.indirect, this.area]);
        this.boundsTarget = createFramebuffer(gl, [passes.atlas.tileLight]);
    }

    // Nothing bounds radiance, as long as PHATexels of an older scene are among those of a new one.
    forget() {
        if (!this.isKnown) return;
        const { gl } = this;
        this.isKnown = false;
        this.pass.begin();
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.boundsTarget);
        gl.clearBufferfv(gl.COLOR, 0, [kUnbounded, kUnbounded, kUnbounded, 0]);
    }

    // `brightest`: radiance that nothing exceeds.
    find(brightest) {
        const { gl, pass, size } = this,
            { passes, programs } = pass,
            { brightest: first, bounds } = programs;
        this.isKnown = true;
        pass.begin();
        first.use();
        first.bind('phatexels', 0, gl.TEXTURE_2D_ARRAY, passes.phatexels);
        first.set('layerCount', passes.lookup.layerCount);
        first.set('unitMeters', passes.bake.atlas.unitMeters);
        pass.draw(this.brightestTarget, size);
        bounds.use();
        bounds.bind('indirect', 0, gl.TEXTURE_2D, this.indirect);
        bounds.bind('area', 1, gl.TEXTURE_2D, this.area);
        bounds.bind('tileTable', 2, gl.TEXTURE_2D, passes.atlas.tileTable);
        bounds.set('brightest', brightest);
        pass.draw(this.boundsTarget, size);
    }

    dispose() {
        const { gl } = this;
        for (const texture of [this.indirect, this.area]) gl.deleteTexture(texture);
        for (const target of [this.brightestTarget, this.boundsTarget]) gl.deleteFramebuffer(target);
    }
}
