// The GLTFLoader plug-in, and the light that it loads.
import {
    DataTexture,
    EquirectangularReflectionMapping,
    ExternalTexture,
    FloatType,
    LinearFilter,
    LinearSRGBColorSpace,
} from 'three';
import { AddedMeshes } from './added.js';
import {
    canLookUp,
    kName,
    readAtlas,
    readDistances,
    readEnvironment,
    readGuides,
    readLayer,
} from './file.js';
import { injectLight } from './inject.js';
import { isBlended } from './material.js';
import { Rendering } from './rendering.js';
import { gatherSurfaces, surfaceMeshes, triangleCount } from './surfaces.js';

// loader.register((parser) => new PhatexturesExtension(parser))
export class PhatexturesExtension {
    constructor(parser) {
        this.name = kName;
        this.parser = parser;
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

export class BakedLight {
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
        this.clock = null; // for measurements: its ended(pass) is called where a pass ends
        this.isWhole = true;
        this.progress = 0;
        this.onProgress = null;
        this.bake = bake;
        this.unitMeters = bake.atlas.unitMeters;
        this.renderings = new Map(); // by their renderers
        const pictures = () => ({ light: new ExternalTexture(), depth: new ExternalTexture() });
        this.pictures = { opaque: pictures(), blended: pictures() };
        const materials = new Set();
        this.undo = bake.surfaces.drawRanges.map(({ mesh }) => {
            const { onBeforeRender } = mesh;
            mesh.onBeforeRender = (renderer, scene, camera, ...rest) => {
                onBeforeRender.call(mesh, renderer, scene, camera, ...rest);
                this.draw(renderer, camera, rest[1]);
            };
            if (mesh.material.isMeshStandardMaterial) materials.add(mesh.material);
            return () => {
                mesh.onBeforeRender = onBeforeRender;
            };
        });
        this.corner = { value: [0, 0] };
        this.materials = new Map([...materials].map((m) => [m, injectLight(m, this.corner)]));
        this.materials.forEach(({ undo }) => this.undo.push(undo));
        this.ready = this.load(parser, description);
        this.ready.catch(() => {}); // whoever awaits it is told
        this.canTrace = Boolean(description.bvh);
        this.file = [parser, description];
        this.added = new AddedMeshes(root, parser, description);
        this.environment = null;
    }

    // Lights what was not in the bake by the bake's probes, instead of ambient light.
    add(object) {
        return this.added.add(object);
    }

    remove(object) {
        this.added.remove(object);
    }

    // Loads what makes light follow the lamps when it is first read.
    get lights() {
        this.loadingLights ??= import('./light_updates.js').then(({ LightUpdates }) => {
            this.updates = new LightUpdates(this, ...this.file);
            return this.updates.lamps;
        });
        return this.loadingLights;
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
    async load(parser, description) {
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

    // Reads what rays are traced through, once. Where that cannot be read, reflections are looked up.
    loadTrees() {
        this.loadingTrees ??= this.beginTrees();
        return this.loadingTrees;
    }

    async beginTrees() {
        try {
            const tracing = await import('./ray_tracing.js'),
                trees = await tracing.readTrees(...this.file, this.bake.surfaces);
            if (!this.disposed) this.bake = { ...this.bake, tracing, trees };
        } catch (error) {
            this.canTrace = false;
            console.warn(error.message);
        }
        this.onProgress?.();
    }

    // Before a surface is drawn: the light of the picture that it is drawn in.
    draw(renderer, camera, material) {
        // Post-processing draws with materials of its own, which show no light.
        if (!this.materials.has(material)) return;
        if (!this.renderings.has(renderer)) this.renderings.set(renderer, new Rendering(renderer));
        const shown = this.renderings.get(renderer).draw(this, camera);
        if (shown) this.show(shown);
    }

    show({ targets, corner }) {
        this.corner.value = corner;
        for (const kind of ['opaque', 'blended']) {
            this.pictures[kind].light.sourceTexture = targets[kind]?.light ?? null;
            this.pictures[kind].depth.sourceTexture = targets[kind]?.depth ?? null;
        }
        for (const [material, { uniforms }] of this.materials) {
            const { light, depth } = this.pictures[isBlended(material) ? 'blended' : 'opaque'];
            uniforms.phatLight.value = light;
            uniforms.phatDepth.value = depth;
            uniforms.phatBehindDepth.value = this.pictures.opaque.depth;
        }
    }

    dispose() {
        this.disposed = true;
        this.undo.forEach((undo) => undo());
        this.undo = [];
        this.added.dispose();
        this.updates?.dispose();
        this.renderings.forEach((rendering) => rendering.dispose());
        this.renderings.clear();
        this.environment?.dispose();
        for (const { light, depth } of Object.values(this.pictures))
            [light, depth].forEach((texture) => texture.dispose());
        this.bake = null;
    }
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
