// Draws the surfaces with their materials, as the passes do.
// twin: src/gl/surface_drawing.h.
import { alphaMode, isBlended, kMaterialRows, kOpaque, kOpaqueSlots, kSlots, packMaterial } from './material.js';
import { uploadTexture, webglTexture } from './three_internals.js';

// Of the 16 units that every device has the display pass needs none for punctual lights, which are three.js's own.
const kFirstMaterialUnit = 7,
    kTransmissionUnit = 5;

export class SurfaceDrawing {
    // `white`: a texture for slots without one.
    constructor(gl, renderer, surfaces, white) {
        Object.assign(this, { gl, renderer, surfaces, white });
        this.rows = new Float32Array(4 * kMaterialRows);
    }

    // `slotCount`: how many of the slots the program reads; 0: nothing of the material.
    bindMaterial(program, material, slotCount) {
        const { gl, renderer } = this;
        packMaterial(material, this.rows);
        // Blending itself is three.js's.
        program.set('alphaMode', isBlended(material) ? kOpaque : alphaMode(material));
        kSlots.slice(0, slotCount).forEach(([sampler, textureOf], i) => {
            const texture = textureOf(material);
            const uploaded = texture && webglTexture(renderer, texture);
            const unit = i < kOpaqueSlots ? kFirstMaterialUnit + i : kTransmissionUnit;
            program.bind(sampler, unit, gl.TEXTURE_2D, uploaded ?? this.white);
        });
        program.set('material', this.rows);
    }

    uploadMaps(copies) {
        for (const { mesh } of [...this.surfaces.drawRanges, ...copies]) {
            for (const [, textureOf] of kSlots) {
                const texture = textureOf(mesh.material);
                if (texture) uploadTexture(this.renderer, texture);
            }
        }
    }

    draw(program, view, slotCount) {
        const { drawRanges } = this.surfaces;
        this.setView(program, view);
        drawRanges.forEach((range, i) => {
            if (view.isVisible(range.mesh)) this.drawRange(program, range, i, { view, slotCount });
        });
        for (const { range, mesh, ...own } of view.copies) {
            this.setView(program, own);
            this.drawRange(program, { ...drawRanges[range], mesh }, range, { view, slotCount });
        }
    }

    // `occluders`: see occluders.js; none of a copy of the room.
    setView(program, { clipFromWorld, eye, eyeAtInfinity, occluders }) {
        program.set('clipFromWorld', clipFromWorld);
        program.offer('eyeWorld', eye);
        program.offer('eyeAtInfinity', eyeAtInfinity);
        program.offer('occluderCount', occluders?.count ?? 0);
        if (occluders) program.offer('occluders', occluders.rows);
    }

    drawRange(program, { mesh, first, count }, index, { view, slotCount }) {
        const { gl } = this;
        if (isBlended(mesh.material) !== view.blended) return;
        if (mesh.material.side === 2) gl.disable(gl.CULL_FACE);
        else gl.enable(gl.CULL_FACE);
        program.offer('surfaceIndex', index);
        if (slotCount > 0) this.bindMaterial(program, mesh.material, slotCount);
        gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
    }
}
