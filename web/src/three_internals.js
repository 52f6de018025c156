// Undocumented parts of three.js that the passes use: the WebGL texture behind a Texture, which
// `renderer.properties` holds as `__webglTexture` with the `__version` that was uploaded. Throws where a
// release of three.js keeps them otherwise, for without them every map would silently be white.
import { REVISION } from 'three';

// As in `peerDependencies` of package.json; 180 and 187 have been tested.
const kMinRevision = 180;

function fail(revision, reason) {
    throw new Error(`baked light cannot be drawn by three.js r${revision}: ${reason}`);
}

// `revision`: as three.js exports it, a number and perhaps letters.
export function requireRevision(revision = REVISION) {
    if (!(parseInt(revision, 10) >= kMinRevision)) fail(revision, `it needs r${kMinRevision} or newer`);
}

// Uploads what `texture` holds now, unless that has been done. three.js does so itself when it first draws
// with it, which is after the passes.
export function uploadTexture(renderer, texture) {
    if (!texture.image || renderer.properties.get(texture).__version === texture.version) return;
    renderer.initTexture(texture);
    // three.js leaves out textures without content and images that are still loading.
    if (texture.version === 0 || texture.image.complete === false) return;
    const properties = renderer.properties.get(texture);
    if (!('__webglTexture' in properties) || properties.__version !== texture.version)
        fail(REVISION, 'it keeps its textures elsewhere');
}

// The WebGLTexture, or undefined before the first upload.
export function webglTexture(renderer, texture) {
    return renderer.properties.get(texture).__webglTexture;
}
