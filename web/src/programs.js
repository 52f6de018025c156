// The programs of the passes, and which of them the next picture is drawn with.
// twin: Renderer::State::previews in src/gl/renderer_state.h.
import { ShaderProgram } from './gl.js';

// What a picture is drawn with: preview.frag alone, all but the lookup, or everything.
export const kPreview = 0,
    kDisplay = 1,
    kWhole = 2;

export class Programs {
    // `clearcoat`, `area`: whether any material has a coat, and whether there are area lights.
    constructor(gl, { clearcoat, area }) {
        this.gl = gl;
        this.defines = [...(clearcoat ? ['CLEARCOAT'] : []), ...(area ? ['AREA'] : [])];
        this.stage = -1; // of the last picture
        this.depth = new ShaderProgram(gl, 'surface.vert', 'depth.frag');
        this.preview = new ShaderProgram(gl, 'surface.vert', 'preview.frag', [
            ...(area ? ['AREA'] : []),
            'WITHOUT_PUNCTUAL_LIGHTS',
        ]);
    }

    // The lookup is another program where there are several layers of PHATexels.
    setScrambles(scrambles) {
        if (this.scrambles === scrambles) return;
        this.scrambles = scrambles;
        this.lookup?.dispose();
        this.lookup = null;
    }

    // Begins to compile what is missing of the whole picture.
    complete(looksUp) {
        const { gl, defines } = this;
        this.display ??= new ShaderProgram(gl, 'surface.vert', 'display.frag', [
            ...defines,
            'LOOKUP',
            'WITHOUT_PUNCTUAL_LIGHTS',
            'TRANSMISSION_TEXTURE',
        ]);
        if (!looksUp) return;
        this.lobes ??= new ShaderProgram(gl, 'surface.vert', 'lobes.frag', defines);
        this.pool ??= new ShaderProgram(gl, 'fullscreen.vert', 'pool.frag', defines);
        const ofLookup = this.scrambles ? [...defines, 'SCRAMBLES'] : defines;
        this.lookup ??= new ShaderProgram(gl, 'surface.vert', 'lookup.frag', ofLookup);
    }

    // Chooses what the next picture is drawn with. `looksUp`: whether there are PHATexels; `waits`: everything, however
    // long that takes. Else the first picture is a preview, and so are those that follow until more is compiled. A
    // picture brings one stage at most, because some drivers compile when a program draws for the first time.
    choose(looksUp, waits) {
        this.looksUp = looksUp;
        this.stage = this.next(waits);
    }

    next(waits) {
        if (!waits && this.stage < kPreview) return kPreview;
        const { looksUp } = this;
        this.complete(looksUp);
        if (waits) return looksUp ? kWhole : kDisplay;
        if (!this.display.isReady()) return kPreview;
        const canLookUp = looksUp && [this.lobes, this.lookup, this.pool].every((program) => program.isReady());
        return canLookUp && this.stage >= kDisplay ? kWhole : kDisplay;
    }

    // Whether the last picture shows all that is loaded.
    isWhole() {
        return this.stage === (this.looksUp ? kWhole : kDisplay);
    }

    dispose() {
        for (const name of ['depth', 'preview', 'lobes', 'lookup', 'pool', 'display']) this[name]?.dispose();
    }
}

// Programs that are compiled together.
export class ProgramSet {
    // `all`: the programs by their names.
    constructor(all) {
        this.all = all;
    }

    isReady() {
        return Object.values(this.all).every((program) => program.isReady());
    }

    dispose() {
        Object.values(this.all).forEach((program) => program.dispose());
    }
}
