/**
 * `<phat-viewer>`, the element of which the page of `phat web` is made: `<script type="module" src="room-site/phat-viewer.js">`
 * in any page. Attributes, events and methods are in the manner of `<model-viewer>`.
 */
export interface PhatViewerElement extends HTMLElement {
    /** Attribute `src`: a `.phat.glb`, or the `room.HASH.glb` of a page's folder. Another one replaces the room. */
    src: string;
    /** Attribute `poster`: a picture until the room is drawn. An `<img slot="poster">` does so before the script is loaded. */
    poster: string;
    /** Attribute `camera`: a viewpoint's name, or "eye target fov" as seven numbers; empty: the first viewpoint. A later change moves there. */
    camera: string;
    /** Attribute `exposure`: stops. Default: 0. */
    exposure: number;
    /** Attribute `quality`: the directions that are sampled for a pixel, as `BakedLight.quality`. Default: `default`. */
    quality: '' | 'fast' | 'default' | 'high';
    /** Attribute `controls`: buttons and settings in the picture. The pointer and keys move the view without them, too. */
    controls: boolean;
    /** Attribute `xr`: with `controls` a button that enters the room in a headset, where the browser offers `immersive-vr`. */
    xr: boolean;
    /** Attribute `mode`; empty: on foot inside rooms, else in orbit. */
    mode: '' | 'walk' | 'orbit';
    /** Attribute `variant-name`: of the file's `KHR_materials_variants`; null: as in the file. Unknown names change nothing. */
    variantName: string | null;
    /** Empty until `load`, as the next two. */
    readonly availableVariants: string[];
    readonly viewpoints: string[];
    readonly materials: string[];
    /** Whether the room can be drawn; reflections may still be loading. */
    readonly loaded: boolean;
    /** "eye;target;fov", as in the address after `#view=`. What is set is moved to. Throws TypeError for other text. */
    view: string;
    /** The room's lamps, to switch, dim and colour: those of `BakedLight.lights`. */
    readonly lamps: Promise<import('./index').Lamp[]>;
    /** Changes all materials of that name, as lit by the bake. Throws RangeError where there is none. pre: loaded. */
    setMaterial(name: string, change: { color?: string; roughness?: number; metalness?: number }): void;
    /** Ends a move to a viewpoint where it leads to. */
    jumpCameraToGoal(): void;
    /** The picture as it is shown. Rejects before `load`. */
    toBlob(options?: { mimeType?: string; qualityArgument?: number }): Promise<Blob | null>;

    addEventListener<K extends keyof PhatViewerEventMap>(
        type: K,
        listener: (this: PhatViewerElement, event: PhatViewerEventMap[K]) => void,
        options?: boolean | AddEventListenerOptions,
    ): void;
    addEventListener(
        type: string,
        listener: EventListenerOrEventListenerObject,
        options?: boolean | AddEventListenerOptions,
    ): void;
}

export interface PhatViewerEventMap {
    /** The room can be drawn. */
    load: CustomEvent<{ url: string }>;
    /** 0 to 1; 1: the reflections are there, too. */
    progress: CustomEvent<{ totalProgress: number }>;
    /** `message` is a sentence for readers, in the page's language. */
    error: CustomEvent<{ type: 'loadfailure'; message: string; sourceError: Error }>;
    /** The room has taken the place of the poster. */
    'poster-dismissed': CustomEvent<object>;
    'camera-change': CustomEvent<{ source: 'user-interaction' | 'automatic' }>;
    'variant-applied': CustomEvent<{ name: string | null }>;
    /** Of the room in a headset; `failed`: it could not be entered. */
    'xr-status': CustomEvent<{ status: 'session-started' | 'not-presenting' | 'failed' }>;
    /** By `setMaterial`. */
    'material-change': CustomEvent<{ name: string }>;
}

declare global {
    interface HTMLElementTagNameMap {
        'phat-viewer': PhatViewerElement;
    }
}
