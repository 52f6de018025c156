// <phat-viewer>: a baked room in any page. Attributes, events and methods are in the manner of <model-viewer>; viewer.d.ts
// declares them.
import { viewFrom } from './navigation.js';
import { createRenderer, loadRoom } from './room.js';
import { createShadow, replaceCanvas } from './shadow.js';
import { followAddress, viewOfAddress } from './share.js';
import { translate, wordsOf } from './strings/strings.js';
import { Viewer } from './viewer.js';

// Of a file without a camera, if the page says none: from a corner of a cube, as wide as the scene.
const kFirstView = (radius) => `${radius} ${radius} ${radius} 0 0 0 45`;

const reducesMotion = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

// As the file has it: three.js replaces spaces and points.
const nameOf = ({ name, userData }) => userData.name ?? name;

export class PhatViewer extends HTMLElement {
    static observedAttributes = ['src', 'poster', 'camera', 'exposure', 'quality', 'controls', 'xr', 'mode', 'variant-name'];

    #attempt = null; // to load; another one has begun where it is not the same
    #variants = null;
    #undo = []; // what ends with the room

    constructor() {
        super();
        this.viewer = null; // null until the room can be drawn; of the Viewer's members none is promised to pages
        this.loaded = false;
        createShadow(this);
    }

    connectedCallback() {
        if (!this.#attempt) this.#begin();
    }

    // An element that is moved in the document is connected again at once, and keeps its room.
    disconnectedCallback() {
        queueMicrotask(() => this.isConnected || this.#end());
    }

    attributeChangedCallback(name, before, value) {
        if (before === value) return;
        const { viewer } = this;
        if (name === 'src') this.#begin();
        else if (name === 'poster') this.#posterChanged(value);
        else if (!viewer) return;
        else if (name === 'camera') viewer.navigation.travel(this.#firstView());
        else if (name === 'exposure') {
            viewer.exposure = this.exposure;
            viewer.present();
        } else if (name === 'quality') viewer.setQuality(value);
        else if (name === 'controls' || name === 'xr') this.#showControls();
        else if (name === 'mode') viewer.navigation.ask(this.mode);
        else if (name === 'variant-name') this.#applyVariant();
    }

    // For all parts of the viewer: an element of the shadow root by its id.
    find(id) {
        return this.shadowRoot.getElementById(id);
    }

    get availableVariants() {
        return this.#variants?.names ?? [];
    }

    // Null: as in the file.
    get variantName() {
        return this.getAttribute('variant-name');
    }

    set variantName(name) {
        if (name === null) this.removeAttribute('variant-name');
        else this.setAttribute('variant-name', name);
    }

    // Each with a colour, which stands for it.
    get variants() {
        return this.#variants?.swatches ?? [];
    }

    get viewpoints() {
        return (this.viewer?.cameras ?? []).map((camera, i) => nameOf(camera) || this.words('viewpointNumber', { number: i + 1 }));
    }

    get materials() {
        return [...new Set((this.viewer?.materials ?? []).map(({ name }) => name).filter(Boolean))];
    }

    setMaterial(name, { color, roughness, metalness }) {
        const all = (this.viewer?.materials ?? []).filter((material) => material.name === name);
        if (all.length === 0) throw new RangeError(`the room has no material "${name}"`);
        for (const material of all) {
            if (color !== undefined) material.color.set(color);
            Object.assign(material, { roughness: roughness ?? material.roughness, metalness: metalness ?? material.metalness });
        }
        this.viewer.changed();
        this.#tell('material-change', { name });
    }

    // The room's lamps, whose light the room follows: see BakedLight.lights.
    get lamps() {
        return this.viewer ? this.viewer.light.lights : Promise.resolve([]);
    }

    get view() {
        return this.viewer?.navigation.view ?? '';
    }

    set view(text) {
        const view = viewFrom(text);
        if (!view) throw new TypeError(`"${text}" is no view: eye;target;fov`);
        this.viewer?.navigation.travel(view);
    }

    // Ends a move to a viewpoint where it leads to.
    jumpCameraToGoal() {
        this.viewer?.navigation.jump();
    }

    // What is shown. As <model-viewer> has it.
    async toBlob({ mimeType = 'image/png', qualityArgument } = {}) {
        if (!this.viewer) throw new Error('there is no picture yet');
        const canvas = this.viewer.presentSome();
        return new Promise((done) => {
            canvas.toBlob(done, mimeType, qualityArgument);
        });
    }

    // Times of the passes; `search`: of a page's address with ?bench.
    async measure(search) {
        const { bench, framesAsked } = await import('./bench.js');
        return bench(this.viewer, framesAsked(search));
    }

    #tell(name, detail = {}) {
        this.dispatchEvent(new CustomEvent(name, { detail }));
    }

    #part(name) {
        return this.shadowRoot.querySelector(`[part=${name}]`);
    }

    get #posters() {
        return this.shadowRoot.querySelector('slot[name=poster]').assignedElements({ flatten: true });
    }

    #posterChanged(value) {
        const image = this.#part('poster');
        if (value === null) image.removeAttribute('src');
        else image.src = value;
    }

    #firstView() {
        const { cameras, navigation } = this.viewer,
            asked = this.camera;
        return (
            cameras.find((camera) => nameOf(camera) === asked) ??
            viewFrom(asked) ??
            cameras[0] ??
            viewFrom(kFirstView(navigation.radius))
        );
    }

    // All attributes are there when it begins.
    #begin() {
        const attempt = (this.#attempt = {});
        queueMicrotask(() => {
            if (attempt !== this.#attempt) return;
            this.#end();
            if (!this.isConnected || !this.src) return;
            this.#attempt = attempt;
            this.#load(attempt);
        });
    }

    #end() {
        this.#attempt = null;
        this.#undo.splice(0).forEach((undo) => undo());
        this.#hideControls();
        this.viewer?.dispose();
        Object.assign(this, { viewer: null, loaded: false });
        this.#variants = null;
        for (const poster of this.#posters) poster.hidden = false;
    }

    async #load(attempt) {
        const isOld = () => attempt !== this.#attempt,
            src = this.src;
        const language = this.closest('[lang]')?.lang || navigator.language;
        let context;
        this.#progress(0);
        this.#part('message').hidden = true;
        try {
            this.words = await wordsOf(language);
            this.numbers = new Intl.NumberFormat(language, { minimumFractionDigits: 2, maximumFractionDigits: 2 });
            if (isOld()) return;
            translate(this.shadowRoot, this.words);
            const canvas = replaceCanvas(this.shadowRoot, this.words);
            context = canvas.getContext('webgl2', { antialias: false, powerPreference: 'high-performance' });
            const renderer = createRenderer(canvas, context);
            const gltf = await loadRoom(src, ({ loaded, total }) => {
                if (total && !isOld()) this.#progress(loaded / total / 2);
            });
            if (isOld()) {
                renderer.forceContextLoss();
                return;
            }
            if (!gltf.userData.bakedLight) throw new Error(this.words('notBaked'));
            await this.#show(renderer, gltf);
            if (isOld()) return;
            this.#tell('load', { url: src });
            await this.#complete(gltf, isOld);
        } catch (error) {
            if (!isOld()) await this.#fail({ error, room: src, context });
        }
    }

    async #show(renderer, gltf) {
        const { exposure, quality } = this,
            rooms = this.getAttribute('rooms') ?? '';
        const viewer = (this.viewer = new Viewer(renderer, gltf, { exposure, quality, rooms, reducesMotion }, {
            viewChanged: (byUser) => this.#viewChanged(byUser),
            drawn: () => this.#drawn(),
            failed: (error) => this.#failed(error),
        }));
        viewer.navigation.asked = this.mode;
        if (gltf.parser.json.extensions?.KHR_materials_variants) {
            const { Variants } = await import('./variants.js');
            if (viewer !== this.viewer) return;
            this.#variants = new Variants(viewer, gltf);
            await this.#applyVariant();
            if (viewer !== this.viewer) return;
        }
        viewer.begin((this.hasAttribute('share') && viewOfAddress()) || this.#firstView());
        if (this.hasAttribute('share')) this.#undo.push(followAddress(this));
        this.loaded = true;
    }

    // What is loaded after the room itself.
    async #complete(gltf, isOld) {
        const { viewer } = this,
            has = (test) => (gltf.parser.json.nodes ?? []).some(({ extras }) => test(extras?.phat ?? {}));
        viewer.light.onProgress = () => {
            if (isOld()) return;
            if (viewer.light.progress < 1) this.#progress(0.5 + viewer.light.progress / 2);
            viewer.changed();
        };
        const loading = [this.#showControls()];
        if (has(({ hotspot }) => typeof hotspot === 'string')) loading.push(this.#showHotspots(gltf));
        await viewer.light.ready;
        await Promise.all(loading);
        if (gltf.animations[0] || has(({ movable }) => movable)) {
            const { Moves } = await import('./moves.js');
            if (!isOld()) viewer.moves = new Moves(this, gltf);
        }
        if (!isOld()) this.#progress(1);
    }

    async #showControls() {
        this.#hideControls();
        if (!this.controls) return;
        const { viewer } = this,
            { Controls } = await import('./controls.js');
        if (viewer === this.viewer && this.controls && !this.ui) this.ui = new Controls(this);
    }

    #hideControls() {
        this.ui?.dispose();
        this.ui = null;
    }

    async #showHotspots(gltf) {
        const { viewer } = this,
            { Hotspots } = await import('./hotspots.js');
        if (viewer !== this.viewer) return;
        const hotspots = new Hotspots(this, gltf.scene);
        this.#undo.push(() => hotspots.dispose());
    }

    async #applyVariant() {
        if (await this.#variants?.apply(this.variantName)) this.#tell('variant-applied', { name: this.variantName });
    }

    #progress(totalProgress) {
        const bar = this.#part('progress');
        bar.value = totalProgress;
        bar.hidden = totalProgress === 1;
        this.#tell('progress', { totalProgress });
    }

    #viewChanged(byUser) {
        const { mode } = this.viewer.navigation;
        this.find('help').textContent = [`pointer${mode === 'walk' ? 'Walk' : 'Orbit'}`, `keys${mode === 'walk' ? 'Walk' : 'Orbit'}`]
            .map((name) => this.words(name))
            .join(' ');
        this.#tell('camera-change', { source: byUser ? 'user-interaction' : 'automatic' });
    }

    #drawn() {
        for (const poster of this.#posters) {
            if (poster.hidden) continue;
            poster.hidden = true;
            this.#tell('poster-dismissed');
        }
    }

    // While it was drawn.
    #failed(error) {
        this.#say(this.words('cannotDraw', { cause: error.message }), error);
    }

    async #fail(failure) {
        const { words } = this,
            { error } = failure;
        const general = words?.('cannotLoad', { cause: error.message }) ?? error.message,
            cause = import('./failure.js').then(({ causeOf }) => causeOf(failure, words));
        this.#say(await cause.catch(() => general), error);
    }

    #say(message, sourceError) {
        console.error(sourceError);
        const text = this.#part('message');
        this.#part('progress').hidden = true;
        Object.assign(text, { textContent: message, hidden: false });
        this.#tell('error', { type: 'loadfailure', message, sourceError });
    }
}

function reflect(name, { read, write }) {
    Object.defineProperty(PhatViewer.prototype, name, {
        get() {
            return read(this.getAttribute(name));
        },
        set(value) {
            const text = write(value);
            if (text === null) this.removeAttribute(name);
            else this.setAttribute(name, text);
        },
        enumerable: true,
        configurable: true,
    });
}

const text = { read: (value) => value ?? '', write: String };
for (const name of ['src', 'poster', 'camera', 'quality', 'mode']) reflect(name, text);
reflect('exposure', { read: (value) => Number(value) || 0, write: String });
for (const name of ['controls', 'xr']) reflect(name, { read: (value) => value !== null, write: (value) => (value ? '' : null) });

customElements.define('phat-viewer', PhatViewer);
