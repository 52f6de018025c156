// The picture of a view at rest, in all of the screen's pixels, where a device is too slow to draw these at once: some rows
// after the others, so that the page stays responsive. It is shown once all rows of a sample are there.
import { jitterOf } from '../src/index.js';
import { isGlass } from '../src/material.js';
import { Picture } from './picture.js';

// Pictures that it is averaged from: fewer than where a device is fast, and they take longer.
const kSamples = 8,
    kBetterSamples = 4; // than the poster, whose edges are smooth and whose noise is little
// What is drawn in a frame: rows that take this time, but no fewer than that, as each part also draws rows beside it and
// goes through all of the room's vertices.
const kPartSeconds = 0.1,
    kMinRows = 16;
const kMaxGrowth = 2; // of a part over the one before

export class StillPicture {
    // `viewer`: see viewer.js.
    constructor(viewer) {
        this.viewer = viewer;
        this.picture = new Picture(viewer.renderer);
        this.row = 0; // the first that is not drawn yet
        this.rows = kMinRows; // of the next part
        this.isTouched = false; // whether the visitor has done anything
        this.listening = new AbortController();
        const { signal } = this.listening;
        for (const event of ['pointerdown', 'wheel', 'keydown'])
            addEventListener(event, () => (this.isTouched = true), { once: true, capture: true, signal });
    }

    setSize(width, height) {
        this.picture.setSize(width, height);
        this.forget();
    }

    // The view or its light is another one.
    forget() {
        this.picture.samples = 0;
        this.row = 0;
    }

    get isShown() {
        return this.picture.samples > 0;
    }

    get isDone() {
        return this.picture.samples >= kSamples;
    }

    // Whether the device is too slow for all pixels at once. Glass shows what is behind it, which would be drawn anew for
    // each part of a picture.
    get isNeeded() {
        const { light, scale } = this.viewer;
        return scale < 1 && !light.bake.surfaces.drawRanges.some(({ mesh }) => isGlass(mesh.material));
    }

    // Whether a coarse picture of the view at rest is there, and this may follow.
    get isDue() {
        const { light, picture } = this.viewer;
        return light.isSettled && picture.samples > 0 && this.isNeeded;
    }

    // A coarse picture is worse than the poster, but shows what the visitor does.
    get hasBetterPoster() {
        return this.isNeeded && !this.isTouched;
    }

    // Draws the next rows, and shows a sample that is complete. Returns how many.
    advance() {
        const { picture, row } = this,
            { scene, camera, light, quality } = this.viewer,
            { width, height } = picture.target,
            [x, y] = jitterOf(picture.samples, kSamples),
            rows = Math.min(this.rows, height - row);
        // Rays would be traced for all of the picture each time.
        Object.assign(light, { quality, seed: picture.samples, reflectionMilliseconds: 0 });
        camera.setViewOffset(width, height, -x, y, width, height);
        picture.drawRows(scene, camera, row, rows);
        this.row = row + rows;
        if (this.row === height) {
            this.row = 0;
            picture.accumulate(Infinity);
            this.viewer.present();
            if (picture.samples >= kBetterSamples) this.viewer.host.drawn();
        }
        return rows;
    }

    // Of the last part.
    learn(rows, seconds) {
        const fitting = (kPartSeconds / Math.max(seconds, 1e-3)) * rows;
        this.rows = Math.max(Math.floor(Math.min(fitting, kMaxGrowth * this.rows)), kMinRows);
    }

    dispose() {
        this.listening.abort();
    }
}
