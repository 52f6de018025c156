// What rays read of a room: trees, surfaces, emitters, lights, the environment.
// twin: GpuRayScene in src/gl/ray_pass.h, src/gl/bvh_upload.cpp.
import { uploadEnvironment } from './environment_upload.js';
import { prepareUploads } from './fixed.js';
import { HitImages } from './hit_images.js';
import { structureOf } from './hit_materials.js';
import { createOpacity } from './hit_opacity.js';
import { brightestRadiance, emittersOf, glassRows, hasColors, hitTable, kEmitterWords, materialRows } from './hit_tables.js';
import { lightTable } from './light_table.js';
import { isGlass } from './material.js';
import { createTable, kTableWidth } from './tables.js';
import { uploadTexture } from './three_internals.js';

export class RayScene {
    constructor(gl, renderer, bake, noVertices) {
        const { trees, surfaces, tracing } = bake; // the last is ray_tracing.js, for what is loaded elsewhere
        Object.assign(this, { gl, renderer, trees, surfaces, tracing, noVertices });
        prepareUploads(gl);
        this.nodes = createTable(gl, gl.RGBA32UI, trees.nodes);
        this.root = trees.root;
        this.triangles = createTable(gl, gl.RGBA32UI, trees.triangles);
        this.materials = [...new Set(surfaces.drawRanges.map(({ mesh }) => mesh.material))];
        this.colored = hasColors(surfaces.vertices);
        this.structure = '';
        this.revision = 0; // counts changes of what shines and reflects
        this.lightRows = null;
        this.linear = gl.createSampler();
        for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
            gl.samplerParameteri(this.linear, filter, gl.LINEAR);
        for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
            gl.samplerParameteri(this.linear, wrap, gl.CLAMP_TO_EDGE);
    }

    // Follows materials, lights and the environment. pre: the textures of the passes (material.js) are uploaded. Leaves
    // WebGL's state to the caller.
    update({ root, unitMeters, environment }) {
        for (const m of this.materials) if (m.emissiveMap) uploadTexture(this.renderer, m.emissiveMap);
        prepareUploads(this.gl);
        const structure = this.materials.map(structureOf).join();
        if (structure !== this.structure) this.rebuild();
        else this.updateRows();
        this.structure = structure;
        if (this.environmentFrom !== environment || !this.environment) this.replaceEnvironment(environment);
        const { rows, count } = lightTable(root, unitMeters),
            { gl } = this;
        if (!this.lightRows || !isSame(rows, this.lightRows)) {
            gl.deleteTexture(this.lights ?? null);
            this.lights = createTable(gl, gl.RGBA32F, rows);
            Object.assign(this, { lightRows: rows, lightCount: count });
            ++this.revision;
        }
        this.hasGlass = this.materials.some(isGlass);
        this.brightest = brightestRadiance(this.materials, environment?.image.data, count);
    }

    rebuild() {
        const { gl, renderer, trees, surfaces, materials, noVertices } = this;
        this.freeTables();
        ++this.revision;
        const images = (this.images = new HitImages(gl, renderer, materials, noVertices)),
            rows = (this.rows = materialRows(materials, images, this.colored)),
            glass = (this.glass = glassRows(surfaces, images)),
            { table, ...hits } = hitTable({ surfaces, trees, materials, images, glass, rows });
        this.hits = { ...hits, table: createTable(gl, gl.RGBA32UI, table) };
        if (trees.firstTransparent < trees.order.length)
            this.opacity = createOpacity(gl, renderer, { surfaces, trees, materials }, noVertices);
    }

    // After a slider has moved.
    updateRows() {
        const rows = materialRows(this.materials, this.images, this.colored);
        if (isSame(rows, this.rows)) return;
        const emitters = emittersOf(this.surfaces, this.images);
        // A colour may be one that a picture does not have.
        if (emitters.length !== kEmitterWords * this.hits.emitterCount) return this.rebuild();
        this.rows = rows;
        ++this.revision;
        this.write(this.hits.table, 0, rows);
        this.write(this.hits.table, this.hits.firstEmitter, emitters);
    }

    // Words of a table, from a texel on.
    write(table, first, words) {
        const { gl } = this,
            kind = [1, gl.RGBA_INTEGER, gl.UNSIGNED_INT];
        gl.bindTexture(gl.TEXTURE_2D, table);
        for (let at = 0, width; at < words.length; at += 4 * width) {
            const texel = first + at / 4,
                [x, y] = [texel % kTableWidth, Math.floor(texel / kTableWidth)];
            width = Math.min(words.length / 4 - at / 4, kTableWidth - x);
            gl.texSubImage2D(gl.TEXTURE_2D, 0, x, y, width, ...kind, words.subarray(at, at + 4 * width));
        }
    }

    replaceEnvironment(environment) {
        this.freeEnvironment();
        this.environment = uploadEnvironment(this.gl, environment);
        this.environmentFrom = environment;
    }

    freeEnvironment() {
        const { gl, environment } = this;
        for (const texture of [environment?.picture, environment?.choices]) gl.deleteTexture(texture ?? null);
    }

    // What lib/environment_samples.glsl reads, in two units from `unit` on.
    bindEnvironmentSamples(program, unit) {
        const { gl, environment } = this;
        program.bind('environment', unit, gl.TEXTURE_2D, environment.picture);
        program.bind('environmentChoices', unit + 1, gl.TEXTURE_2D, environment.choices);
        program.set('environmentCells', [environment.columns, environment.rows]);
        program.set('environmentCellTexels', environment.cellTexels);
        program.set('turn', 0);
    }

    // What lib/bvh.glsl reads, in four units from `unit` on.
    bindTrees(program, unit) {
        const { gl, opacity, trees } = this;
        program.set('bvhGridStep', trees.gridStep);
        program.set('bvhRoot', this.root);
        program.bind('bvhNodes', unit, gl.TEXTURE_2D, this.nodes);
        program.bind('bvhTriangles', unit + 1, gl.TEXTURE_2D, this.triangles);
        if (!opacity) return;
        program.set('bvhFirstTransparent', trees.firstTransparent);
        program.set('bvhFirstMaterial', opacity.firstMaterial);
        program.bind('bvhOpacity', unit + 2, gl.TEXTURE_2D, opacity.opacity);
        program.bind('bvhAlphas', unit + 3, gl.TEXTURE_2D, opacity.alphas);
    }

    // What lib/hit_surface.glsl reads, in three units from `unit` on.
    bindHits(program, unit) {
        const { gl, hits, images } = this;
        program.set('hitFirstTriangle', hits.firstTriangle);
        program.set('hitFirstEmitter', hits.firstEmitter);
        program.set('emitterCount', hits.emitterCount);
        program.bind('hitTable', unit, gl.TEXTURE_2D, hits.table);
        program.bind('hitColors', unit + 1, gl.TEXTURE_2D_ARRAY, images.colors);
        program.bind('hitLinear', unit + 2, gl.TEXTURE_2D_ARRAY, images.linear);
    }

    freeTables() {
        const { gl, hits, opacity } = this;
        for (const texture of [hits?.table, opacity?.opacity, opacity?.alphas]) gl.deleteTexture(texture ?? null);
        this.images?.dispose();
        this.images = this.hits = this.opacity = null;
    }

    dispose() {
        const { gl } = this;
        this.freeTables();
        this.freeEnvironment();
        for (const texture of [this.nodes, this.triangles, this.lights])
            gl.deleteTexture(texture ?? null);
        gl.deleteSampler(this.linear);
    }
}

function isSame(a, b) {
    return a.length === b.length && a.every((x, i) => x === b[i]);
}
