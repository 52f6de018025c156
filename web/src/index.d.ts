import type {
    Color,
    ColorRepresentation,
    DataTexture,
    MeshStandardMaterial,
    Object3D,
    Scene,
    WebGLRenderer,
} from 'three';
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

/** Reads `PHAT_photon_accumulation_texture`: `loader.register((parser) => new PhatexturesExtension(parser))`. */
export class PhatexturesExtension implements GLTFLoaderPlugin {
    /** `parser`: what GLTFLoader passes to those who register. */
    constructor(parser: GLTFParser);
    /** Of the glTF extension. */
    readonly name: string;
    /** The parser that it was made for. */
    readonly parser: GLTFParser;
    /** Called by GLTFLoader. The lamp of a node that has a photometry (EXT_lights_ies), or null. */
    createNodeAttachment(node: number): Promise<Object3D> | null;
    /** Called by GLTFLoader. Sets what `bakedLightOf` returns where the file is baked. */
    afterRoot(gltf: GLTF): Promise<void>;
}

/** What shines in a room: a punctual light of the file, or all surfaces of a material that emits. */
export interface Lamp {
    /** Of the light's node or of the material. */
    readonly name: string;
    /** Times what it was in the bake, or of a lamp that was off, times 1 in the file's unit; 1 until it is set. */
    intensity: number;
    /** Whether it is switched on; at first not, if it is off in the file. */
    visible: boolean;
    /** Set it to change it: what is done to the colour that it returns changes nothing. */
    get color(): Color;
    set color(color: ColorRepresentation);
    /** As it was in the bake. */
    reset(): void;
}

/**
 * What a baked file adds to its scene: `bakedLightOf(gltf)`. Its materials show it wherever `gltf.scene` is drawn,
 * instead of ambient, hemisphere and environment light, and clones and instances of its meshes; changes of the materials are
 * followed.
 */
export class BakedLight {
    private constructor();
    /** Resolves when the reflections are loaded, diffuse light being there at once; rejects when the file is damaged. */
    readonly ready: Promise<BakedLight>;
    /** 0 to 1: how much of the reflections is loaded. Each part makes the picture better: area lights' highlights come first. */
    readonly progress: number;
    /** Called when `progress` has changed; pages that draw on demand draw then. */
    onProgress: (() => void) | null;
    /** The environment that the file was baked under, for `scene.background`; null if there is none, or before `ready`. */
    readonly environment: DataTexture | null;
    /** Whether the bake's light is drawn. */
    enabled: boolean;
    /** Directions sampled a pixel: 2, 8 or 32. */
    quality: 'fast' | 'default' | 'high';
    /**
     * How reflections are found. `'lookup'`: among the samples of the bake, which are blurred where a surface is sharper than
     * they are dense. `'rays'`: all by rays, whose hits are shaded by the bake, in whatever time it takes. `'auto'`, the
     * default: by rays where they are sharp, and as many as fit into `reflectionMilliseconds`, none on slow devices; the file
     * must have trees for rays, which `phat bake` writes.
     */
    reflections: 'auto' | 'lookup' | 'rays';
    /** GPU time that rays of a picture may take with `'auto'`. Default: 10; Infinity: as many as there are. */
    reflectionMilliseconds: number;
    /** About how long the rays of the last picture took; 0 where its reflections were looked up. */
    readonly tracedMilliseconds: number;
    /**
     * The room's lamps. What one is set to is drawn in the next picture; the light that the room's surfaces reflect of it follows
     * over the next pictures, as rays make PHATexels and irradiance anew. The first use loads what does so (18 kB), the first
     * change allocates about 90 bytes of GPU memory a texel, the first motion 4 more. Rejects, with the reason, where the file lacks what is needed;
     * where that shows later, a warning is logged, and the light stays as it was.
     */
    readonly lights: Promise<Lamp[]>;
    /**
     * From now on, as from the first lamp that is set, the light follows the room's materials, all punctual lights of the scene,
     * and the file's nodes, too: a floor that is painted red reddens the wall, and a table that is moved takes its shadow along.
     * Nodes may be moved and turned, by the page or by animations of the file. What changed before is followed as well. Rejects
     * as `lights` does.
     */
    followChanges(): Promise<void>;
    /** GPU time that this may take of a picture. Default: 4; Infinity: as much as all texels take once. */
    updateMilliseconds: number;
    /** About how long that took in the last picture; 0 where there was nothing to do. */
    readonly updatedMilliseconds: number;
    /** Whether the light is that of the lamps as they are; draw until it is. */
    readonly isSettled: boolean;
    /** Chooses among the noise patterns; give each picture another one where pictures are averaged. */
    seed: number;
    /** Left of this fraction of the picture all light is drawn, to the right only direct light. 1: all. */
    wipe: number;
    /**
     * Whether a picture waits until all programs are compiled. If not, the first pictures show base colours by diffuse light,
     * and those that follow more, as soon as the browser has compiled what they need. Default: true.
     */
    waitsForPrograms: boolean;
    /** Whether the last picture showed all that is loaded; false only where pictures do not wait: draw again then. */
    readonly isWhole: boolean;
    /** A length of about a metre in a room, in the file's metres: files in millimetres have one of about 1000. */
    readonly unitMeters: number;
    /** The object that the light belongs to. */
    readonly root: Object3D;
    /**
     * Lights the meshes of an object that was not in the bake: by the file's light probes instead of ambient, hemisphere and
     * environment light, wherever in the room they move; lights of the scene shine on them as always. What they reflect is
     * blurred over a hemisphere. Resolves when they are lit; rejects where the file has no probes (`phat bake --probes`).
     */
    add(object: Object3D): Promise<void>;
    /** Returns the materials of what was added to what they were. */
    remove(object: Object3D): void;
    /**
     * Lets a MeshStandardMaterial with which the page replaces one of the room's show the light. The file's own do so anyway,
     * with hooks (`onBeforeCompile`) of the page's, too. Throws where it is none.
     */
    adopt(material: MeshStandardMaterial): void;
    /** Frees what is on the GPU. As with all of three.js, what is drawn again is made again. */
    dispose(): void;
    /** Returns all materials to what they were, for good, and frees all. */
    detach(): void;
}

/**
 * The light of what GLTFLoader has read with the plug-in; null where the file is not baked. The same as `gltf.userData.bakedLight`,
 * with a type.
 */
export function bakedLightOf(gltf: Pick<GLTF, 'userData'>): BakedLight | null;

/** Whether baked light can be read and drawn here: WebGL 2 with float render targets, and DecompressionStream. */
export function isSupported(context: WebGLRenderingContext | WebGL2RenderingContext | null): boolean;

/** Position of picture `index` of `count` inside the pixel, for averaging pictures (`Camera.setViewOffset`). */
export function jitterOf(index: number, count: number): [number, number];

/**
 * Makes all point, spot and directional lights of a scene throw shadows, of all its meshes but glass, as they do in the bake:
 * turns the renderer's shadow maps on, and fits them to the scene, from the surfaces that are nearest to a lamp on. Call it
 * when the scene is complete, and again when lights have moved. Where nothing moves, `renderer.shadowMap.autoUpdate = false`
 * draws the maps once.
 */
export function prepareLights(renderer: WebGLRenderer, scene: Scene): void;
