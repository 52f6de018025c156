// The GLTFLoader plug-in, and the light that it loads.
import {
    DataTexture,
    EquirectangularReflectionMapping,
    FloatType,
    LinearFilter,
    LinearSRGBColorSpace,
} from 'three';
import { BakedMaterials } from './baked_materials.js';
import {
    canLookUp,
    kName,
    readAtlas,
    readDistances,
    readEnvironment,
    readGuides,
    readLayer,
} from './file.js';
import { lackOf } from './gl.js';
import { chainHook } from './hooks.js';
import { hidePhotometry, photometricLight, showPhotometry, updatePhotometry } from './photometry.js';
import { Rendering } from './rendering.js';
import { gatherSurfaces, surfaceMeshes, triangleCount } from './surfaces.js';

/** The plug-in: `loader.register((parser) => new PhatexturesExtension(parser))`. */
export class PhatexturesExtension {
    constructor(parser) {
        this.name = kName;
        this.parser = parser;
    }

    // GLTFLoader has no light with photometry.
    createNodeAttachment(node) {
        return photometricLight(this.parser, node);
    }

    // Diffuse light is there when the file is; the PHATexels follow (BakedLight.ready).
    async afterRoot(gltf) {
        const description = this.parser.json.extensions?.[kName];
        if (!description) return;
        const meshes = surfaceMeshes(gltf, description);
        const triangles = meshes.reduce((sum, mesh) => sum + triangleCount(mesh), 0);
        const atlas = await readAtlas(this.parser, description, triangles);
        const surfaces = gatherSurfaces(gltf.scene, meshes, atlas, description.texCoord);
        gltf.userData.bakedLight = new BakedLight(gltf.scene, this.parser, description, {
            atlas,
            surfaces,
            lookup: null,
            trees: null,
        });
    }
}

/** The light of a baked file. What is documented for users, and typed, is in index.d.ts. */
export class BakedLight {
    #renderings = new Map(); // by their renderers
    #lacks = new WeakMap(); // by their renderers: what keeps them from drawing the light
    #materials = new BakedMaterials((...picture) => this.draw(...picture));
    #undo;
    #file;
    #toAdd = new Set();
    #added;
    #loadingAdded;
    #loadingLights;
    #loadingTrees;

    constructor(root, parser, description, bake) {
        this.root = root;
        this.enabled = true;
        this.quality = 'default';
        this.seed = 0;
        this.reflections = 'auto';
        this.reflectionMilliseconds = 10;
        this.tracedMilliseconds = 0;
        this.updateMilliseconds = 4;
        this.updatedMilliseconds = 0;
        this.wipe = 1;
        this.waitsForPrograms = true;
        /** @internal For measurements: its ended(pass) is called where a pass ends. */
        this.clock = null;
        this.isWhole = true;
        this.progress = 0;
        this.onProgress = null;
        /** @internal */
        this.bake = bake;
        showPhotometry(root);
        this.unitMeters = root.userData.unitMeters = bake.atlas.unitMeters;
        /** @internal Whether the light will never be drawn again. */
        this.disposed = false;
        this.#undo = bake.surfaces.drawRanges.map(({ mesh }) => {
            if (mesh.material.isMeshStandardMaterial) this.adopt(mesh.material);
            // Where materials are not asked, as by WebGPURenderer.
            return chainHook(mesh, 'onBeforeRender', (own) => (renderer, ...rest) => {
                own.call(mesh, renderer, ...rest);
                this.#canDraw(renderer);
            });
        });
        this.ready = this.#load(parser, description);
        this.ready.catch(() => {}); // whoever awaits it is told
        /** @internal */
        this.canTrace = Boolean(description.bvh);
        this.#file = [parser, description];
        this.environment = null;
    }

    // Lets a material with which the page replaces one of the room show the light, too.
    adopt(material) {
        if (!material.isMeshStandardMaterial)
            throw new TypeError('only MeshStandardMaterial and MeshPhysicalMaterial show baked light');
        this.#materials.adopt(material);
    }

    // Lights what was not in the bake by the bake's probes, instead of ambient light. Loads what does so.
    async add(object) {
        this.#toAdd.add(object);
        this.#loadingAdded ??= import('./added.js').then(async ({ AddedMeshes }) => {
            this.#added = await AddedMeshes.read(this.root, ...this.#file);
        });
        await this.#loadingAdded;
        if (this.#toAdd.delete(object)) this.#added.add(object);
    }

    remove(object) {
        this.#toAdd.delete(object);
        this.#added?.remove(object);
    }

    /** @internal What keeps light from the room's surfaces: see occluders.js; null: nothing. */
    get occluders() {
        return this.#added?.occluders.in(this.root) ?? null;
    }

    // Loads what makes light follow the lamps when it is first read.
    get lights() {
        this.#loadingLights ??= import('./light_updates.js').then(({ LightUpdates }) => {
            /** @internal */
            this.updates = new LightUpdates(this, ...this.#file);
            return this.updates.lamps;
        });
        return this.#loadingLights;
    }

    async followChanges() {
        await this.lights;
        this.updates.noteChange();
    }

    get isSettled() {
        return this.updates?.isSettled ?? true;
    }

    // The PHATexels, in the order of their effect per byte: area lights' highlights, a first layer of indirect
    // light, then the others. Frames are drawn from the data that have arrived.
    async #load(parser, description) {
        const { indirect, area } = description,
            { atlas } = this.bake,
            hasArea = area.layers.length > 0;
        if (description.environment) {
            const environment = await readEnvironment(parser, description.environment);
            if (this.disposed) return this;
            this.environment = environmentTexture(environment);
        }
        // Area lights need both, their PHATexels and their irradiance.
        if (!canLookUp(indirect) || hasArea !== Boolean(area.irradiance) || (hasArea && !canLookUp(area)))
            return this;
        const steps = indirect.layers.map((_, i) => [indirect, i]);
        if (hasArea) steps.unshift([area, 0]);
        const distances = await readDistances(parser, description, atlas);
        const sources = new Map([
            [indirect, emptySource(atlas)],
            [area, hasArea ? emptySource(atlas) : null],
        ]);
        for (const [step, [source, i]] of steps.entries()) {
            if (i === 0) {
                const [guides, layer] = await Promise.all([
                    readGuides(parser, source),
                    readLayer(parser, source.layers[0], atlas),
                ]);
                sources.set(source, { guides, layers: [layer] });
            } else sources.get(source).layers.push(await readLayer(parser, source.layers[i], atlas));
            if (this.disposed) return this;
            this.bake = {
                ...this.bake,
                lookup: lookupOf(distances, sources.get(indirect), sources.get(area)),
            };
            this.progress = (step + 1) / steps.length;
            this.onProgress?.();
        }
        return this;
    }

    /** @internal Reads what rays are traced through, once. Where that cannot be read, reflections are looked up. */
    loadTrees() {
        this.#loadingTrees ??= this.#beginTrees();
        return this.#loadingTrees;
    }

    async #beginTrees() {
        try {
            const tracing = await import('./ray_tracing.js'),
                trees = await tracing.readTrees(...this.#file, this.bake.surfaces);
            if (!this.disposed) this.bake = { ...this.bake, tracing, trees };
        } catch (error) {
            this.canTrace = false;
            console.warn(error.message);
        }
        this.onProgress?.();
    }

    // Whether a renderer can draw the light. If not, the first time, says why, and shows the room without any.
    #canDraw(renderer) {
        if (!this.#lacks.has(renderer)) {
            const lack = lackOf(renderer);
            this.#lacks.set(renderer, lack);
            if (lack) console.error(`The room is drawn without its light: ${lack}`);
        }
        const lack = this.#lacks.get(renderer);
        if (lack) this.#materials.showUnlit();
        return !lack;
    }

    /**
     * @internal Before a surface is drawn: the light of the picture that it is drawn in. Post-processing that draws with
     * materials of its own shows none.
     */
    draw(renderer, scene, camera) {
        updatePhotometry();
        if (!this.#canDraw(renderer)) return;
        if (!this.#renderings.has(renderer)) this.#renderings.set(renderer, new Rendering(renderer));
        const shown = this.#renderings.get(renderer).draw(this, scene, camera);
        if (shown) this.#materials.show(shown);
    }

    // Frees what is on the GPU. As with all of three.js, what is drawn again is made again.
    dispose() {
        this.#added?.dispose();
        this.#renderings.forEach((rendering) => rendering.dispose());
        this.#renderings.clear();
        this.environment?.dispose();
        this.#materials.dispose();
    }

    // Returns all materials to what they were, for good.
    detach() {
        this.dispose();
        this.disposed = true;
        this.#undo.forEach((undo) => undo());
        this.#materials.detach();
        this.#toAdd.clear();
        this.#added?.detach();
        this.updates?.dispose();
        hidePhotometry(this.root);
        this.bake = null;
    }
}

/** What a file that GLTFLoader has read holds of baked light: a BakedLight, or null where it is not baked. */
export function bakedLightOf(gltf) {
    return gltf.userData.bakedLight ?? null;
}

// A source of light of which nothing is loaded: no PHATexel is valid.
function emptySource({ width, height, blockCount }) {
    const layer = { texels: new Uint32Array(2 * width * height), scrambles: new Uint16Array(blockCount) };
    return { guides: new Uint16Array(256).fill(256), layers: [layer] };
}

// Input of the uploads of Passes.
function lookupOf(distances, indirect, area) {
    const sources = area ? [indirect, area] : [indirect];
    const guides = new Uint16Array(sources.reduce((sum, source) => sum + source.guides.length, 0));
    guides.set(indirect.guides);
    if (area) guides.set(area.guides, indirect.guides.length);
    return {
        distances,
        guides,
        guideCount: indirect.guides.length / 256,
        areaGuideCount: area ? area.guides.length / 256 : 0,
        layers: sources.flatMap((source) => source.layers),
        layerCount: indirect.layers.length,
    };
}

function environmentTexture({ width, height, pixels }) {
    const texture = new DataTexture(pixels, width, height);
    texture.type = FloatType;
    texture.mapping = EquirectangularReflectionMapping;
    texture.colorSpace = LinearSRGBColorSpace;
    texture.minFilter = texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    return texture;
}
