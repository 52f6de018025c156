// What shines in a room, by name.
import { Color } from 'three';
import { emissionOf, isUnlit } from './material.js';

// Of a lamp that is off in the file and has a colour, in the file's unit.
const kStrengthOfLampsThatAreOff = 1;

// A punctual light, or all surfaces of a material that emits, or would if its strength were not 0. What it is set to is
// drawn at once.
export class Lamp {
    #intensity = 1;
    #visible = true;
    #changed;
    #colorKey;
    #strengthKey;
    #strength;
    #baked;
    #own;
    #isOnInBake = true;

    // `source`: a light or a material of three.js; `changed` is called when the lamp is set.
    constructor(source, changed) {
        const isLight = source.isLight === true;
        this.name = source.name;
        /** @internal */
        this.source = source;
        this.#changed = changed;
        this.#colorKey = isLight || isUnlit(source) ? 'color' : 'emissive';
        this.#strengthKey = isLight ? 'intensity' : isUnlit(source) ? null : 'emissiveIntensity';
        this.#strength = this.#strengthKey ? source[this.#strengthKey] : 1;
        if (this.#strength === 0) {
            this.#strength = kStrengthOfLampsThatAreOff;
            this.#visible = this.#isOnInBake = false;
        }
        this.#own = source[this.#colorKey].clone();
        this.#baked = this.#own.clone();
    }

    // Times what it was in the bake; of a lamp that was off, times 1 in the file's unit.
    get intensity() {
        return this.#intensity;
    }
    set intensity(factor) {
        this.#intensity = Math.max(factor, 0);
        this.#write();
    }

    get visible() {
        return this.#visible;
    }
    set visible(visible) {
        this.#visible = Boolean(visible);
        this.#write();
    }

    // Set it to change it: what is done to the colour that it returns changes nothing.
    get color() {
        return this.#own.clone();
    }
    set color(color) {
        this.#own = new Color(color);
        this.#write();
    }

    reset() {
        this.#own = this.#baked.clone();
        this.#intensity = 1;
        this.#visible = this.#isOnInBake;
        this.#write();
    }

    #write() {
        const { source } = this,
            factor = this.#visible ? this.#intensity : 0;
        source[this.#colorKey].copy(this.#own);
        if (this.#strengthKey) source[this.#strengthKey] = factor * this.#strength;
        else source[this.#colorKey].multiplyScalar(factor);
        this.#changed();
    }
}

// Whether a material has a colour to emit, at a strength of 0.
const isOff = (material) =>
    !isUnlit(material) && material.emissiveIntensity === 0 && material.emissive.toArray().some((x) => x > 0);

// The lamps of what `root` holds: its punctual lights, then the materials of `drawRanges` that emit, and where the bake
// has a layer for their light (`hasArea`) those that are off.
export function lampsOf(root, { drawRanges, hasArea }, changed) {
    const sources = new Set();
    root.traverse((object) => {
        if (object.isPointLight || object.isSpotLight || object.isDirectionalLight) sources.add(object);
    });
    for (const { mesh } of drawRanges) {
        const { material } = mesh;
        if (emissionOf(material).some((x) => x > 0) || (hasArea && isOff(material))) sources.add(material);
    }
    return [...sources].map((source) => new Lamp(source, changed));
}
