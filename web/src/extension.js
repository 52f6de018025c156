// The GLTFLoader plug-in, and the light that it loads.
import {
    DataTexture,
    EquirectangularReflectionMapping,
    ExternalTexture,
    FloatType,
    LinearFilter,
    LinearSRGBColorSpace,
    Matrix4,
    Vector2,
    Vector3,
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
import { isSupported } from './gl.js';
import { injectLight } from './inject.js';
import { isBlended } from './material.js';
import { Passes } from './passes.js';
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

function isVisible(object) {
    for (let o = object; o; o = o.parent) if (!o.visible) return false;
    return true;
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
        this.passes = null;
        this.drawnFor = { frame: -1, camera: null };
        this.drawing = false;
        const pictures = () => ({ light: new ExternalTexture(), depth: new ExternalTexture() });
        this.pictures = { opaque: pictures(), blended: pictures() };
        const materials = new Set();
        this.undo = bake.surfaces.draws.map(({ mesh }) => {
            const { onBeforeRender } = mesh;
            mesh.onBeforeRender = (renderer, scene, camera, ...rest) => {
                onBeforeRender.call(mesh, renderer, scene, camera, ...rest);
                this.draw(renderer, camera);
            };
            if (mesh.material.isMeshStandardMaterial) materials.add(mesh.material);
            return () => {
                mesh.onBeforeRender = onBeforeRender;
            };
        });
        this.injected = [...materials].map(injectLight);
        this.undo.push(...this.injected.map(({ undo }) => undo));
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
            this.forgetPasses();
            this.progress = layers.length / indirect.layers.length;
        }
        return this;
    }

    forgetPasses() {
        this.passes?.dispose();
        this.passes = null;
        this.drawnFor.frame = -1;
    }

    // Draws the passes once a frame and camera, before the first of the surfaces.
    draw(renderer, camera) {
        const { frame } = renderer.info.render;
        if (this.drawing || (this.drawnFor.frame === frame && this.drawnFor.camera === camera)) return;
        this.drawnFor = { frame, camera };
        const gl = renderer.getContext();
        if (gl.isContextLost()) return;
        this.drawing = true;
        const target = renderer.getRenderTarget(),
            face = renderer.getActiveCubeFace(),
            level = renderer.getActiveMipmapLevel();
        try {
            if (this.passes?.renderer !== renderer) this.usePasses(renderer, gl);
            const { x: width, y: height } = target
                ? new Vector2(target.width, target.height)
                : renderer.getDrawingBufferSize(new Vector2());
            this.passes.draw(this.viewOf(camera, width, height), this);
            this.showPictures(this.passes.targets);
        } finally {
            this.drawing = false;
            renderer.resetState();
            renderer.setRenderTarget(target, face, level);
        }
    }

    showPictures(targets) {
        for (const kind of ['opaque', 'blended']) {
            this.pictures[kind].light.sourceTexture = targets[kind]?.light ?? null;
            this.pictures[kind].depth.sourceTexture = targets[kind]?.depth ?? null;
        }
        for (const { material, uniforms } of this.injected) {
            const { light, depth } = this.pictures[isBlended(material) ? 'blended' : 'opaque'];
            uniforms.phatLight.value = light;
            uniforms.phatDepth.value = depth;
        }
    }

    usePasses(renderer, gl) {
        if (!isSupported(gl))
            throw new Error('baked light needs WebGL 2 with float render targets (EXT_color_buffer_float)');
        this.forgetPasses();
        this.passes = new Passes(renderer, this.bake);
        // What was made in the lost context is gone with it.
        renderer.domElement.addEventListener(
            'webglcontextrestored',
            (this.onRestored = () => {
                this.passes = null;
                this.drawnFor.frame = -1;
            }),
            { once: true },
        );
    }

    // In the space that the light was baked in.
    viewOf(camera, width, height) {
        const rootFromWorld = new Matrix4().copy(this.root.matrixWorld).invert();
        const clipFromWorld = new Matrix4()
            .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
            .multiply(this.root.matrixWorld);
        const eye = new Vector3();
        if (camera.isOrthographicCamera)
            eye.set(0, 0, 1).transformDirection(camera.matrixWorld).transformDirection(rootFromWorld);
        else eye.setFromMatrixPosition(camera.matrixWorld).applyMatrix4(rootFromWorld);
        return {
            width,
            height,
            clipFromWorld: clipFromWorld.elements,
            eye: eye.toArray(),
            eyeAtInfinity: camera.isOrthographicCamera ? 1 : 0,
            isVisible: (mesh) => this.enabled && isVisible(mesh) && camera.layers.test(mesh.layers),
        };
    }

    dispose() {
        this.disposed = true;
        this.undo.forEach((undo) => undo());
        this.undo = [];
        this.passes?.renderer.domElement.removeEventListener('webglcontextrestored', this.onRestored);
        this.forgetPasses();
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
