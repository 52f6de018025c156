// How long the GPU takes for a part of a picture.
// twin: src/gl/pass_clock.h.
import { createFramebuffer, createTexture2D } from './gl.js';

// Where the GPU has no clock, one picture of so many waits for it.
const kPictures = 30;
// Pictures at the beginning, in which drivers compile, are not measured.
const kWarmUp = 3;

export class PassTimer {
    constructor(gl) {
        this.gl = gl;
        this.extension = gl.getExtension('EXT_disjoint_timer_query_webgl2');
        this.pictures = 0;
        this.pending = null; // { query, about }
        this.isMeasuring = false;
    }

    // The part begins. `about`: returned with its time. May bind another framebuffer, as `end` may.
    begin(about) {
        const { gl, extension } = this;
        this.isMeasuring = false;
        if (++this.pictures < kWarmUp || this.pending) return;
        if (extension) {
            // The page may measure something of its own.
            if (gl.getQuery(extension.TIME_ELAPSED_EXT, gl.CURRENT_QUERY)) return;
            this.pending = { query: gl.createQuery(), about };
            gl.beginQuery(extension.TIME_ELAPSED_EXT, this.pending.query);
        } else {
            if (this.pictures % kPictures !== kWarmUp) return;
            this.wait();
            this.pending = { since: performance.now(), about };
        }
        this.isMeasuring = true;
    }

    end() {
        if (!this.isMeasuring) return;
        this.isMeasuring = false;
        if (this.extension) this.gl.endQuery(this.extension.TIME_ELAPSED_EXT);
        else {
            this.wait();
            this.pending.milliseconds = performance.now() - this.pending.since;
        }
    }

    // { about, milliseconds } of a part that has been measured, or null. Each once.
    take() {
        if (!this.pending) return null;
        const { gl, extension } = this,
            { query, about } = this.pending;
        let { milliseconds } = this.pending;
        if (extension) {
            if (!gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE)) return null;
            milliseconds = gl.getQueryParameter(query, gl.QUERY_RESULT) / 1e6;
            gl.deleteQuery(query);
            if (gl.getParameter(extension.GPU_DISJOINT_EXT)) milliseconds = undefined;
        }
        this.pending = null;
        return milliseconds === undefined ? null : { about, milliseconds };
    }

    // Until the GPU has drawn everything: gl.finish alone does not in all browsers.
    wait() {
        const { gl } = this;
        this.texture ??= createTexture2D(gl, gl.RGBA8, 1, 1);
        this.framebuffer ??= createFramebuffer(gl, [this.texture]);
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.framebuffer);
        gl.finish();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }

    dispose() {
        if (this.pending?.query) this.gl.deleteQuery(this.pending.query);
        this.pending = null;
        this.gl.deleteTexture(this.texture ?? null);
        this.gl.deleteFramebuffer(this.framebuffer ?? null);
    }
}
