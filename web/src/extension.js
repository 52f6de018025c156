// The GLTFLoader plug-in, and the light that it loads.
import {
    DataTexture,
    EquirectangularReflectionMapping,
    ExternalTexture,
    FloatType,
    LinearFilter,
    LinearSRGBColorSpace,
} from 'three';
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
        });
    }
}

export class BakedLight {
    constructor(root, parser, description, bake) {
        this.root = root;
        this.enabled = true;
        this.quality = 'default';
        this.seed = 0;
        this.wipe = 1;
        this.progress = 0;
        this.bake = bake;
        this.renderings = new Map(); // by their renderers
        const pictures = () => ({ light: new ExternalTexture(), depth: new ExternalTexture() });
        this.pictures = { opaque: pictures(), blended: pictures() };
        const materials = new Set();
        this.undo = bake.surfaces.draws.map(({ mesh }) => {
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
        this.environment = null;
    }

    // The PHATexels: of area lights and a first layer of indirect light, then the other layers, each of which
    // makes the picture better.
    async load(parser, description) {
        const { indirect, area } = description,
            { atlas } = this.bake;
        if (description.environment)
            this.environment = environmentTexture(await readEnvironment(parser, description.environment));
        const hasArea = area.layers.length > 0;
        // Area lights need both, their PHATexels and their irradiance.
        if (!canLookUp(indirect) || hasArea !== Boolean(area.irradiance) || (hasArea && !canLookUp(area)))
            return this;
        const readSource = (source) =>
            Promise.all([readGuides(parser, source), readLayer(parser, source.layers[0], atlas)]);
        const [distances, [guides, first], [areaGuides, areaLayer]] = await Promise.all([
            readDistances(parser, description, atlas),
            readSource(indirect),
            hasArea ? readSource(area) : [null, null],
        ]);
        const layers = [first],
            allGuides = new Uint16Array(guides.length + (areaGuides?.length ?? 0));
        allGuides.set(guides);
        if (hasArea) allGuides.set(areaGuides, guides.length);
        for (let i = 0; i < indirect.layers.length; ++i) {
            if (i > 0) layers.push(await readLayer(parser, indirect.layers[i], atlas));
            if (this.disposed) return this;
            const lookup = {
                distances,
                guides: allGuides,
                guideCount: indirect.guideCount,
                areaGuideCount: hasArea ? area.guideCount : 0,
                layers: hasArea ? [...layers, areaLayer] : [...layers],
                layerCount: layers.length,
            };
            this.bake = { ...this.bake, lookup };
            this.renderings.forEach((rendering) => rendering.forget());
            this.progress = layers.length / indirect.layers.length;
        }
        return this;
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
        }
    }

    dispose() {
        this.disposed = true;
        this.undo.forEach((undo) => undo());
        this.undo = [];
        this.renderings.forEach((rendering) => rendering.dispose());
        this.renderings.clear();
        this.environment?.dispose();
        for (const { light, depth } of Object.values(this.pictures))
            [light, depth].forEach((texture) => texture.dispose());
        this.bake = null;
    }
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
