// The passes and targets of one renderer for a baked light.
import { Matrix4, Vector3, Vector4 } from 'three';
import { findCopies } from './copies.js';
import { scissoredPart } from './parts.js';
import { Passes } from './passes.js';

// Whether it is drawn with `scene`.
function isVisible(object, scene) {
    for (let o = object; o?.visible; o = o.parent) if (o === scene) return true;
    return false;
}

// A camera in the space where the light was baked.
function viewOf(worldFromRoot, camera) {
    const rootFromWorld = new Matrix4().copy(worldFromRoot).invert();
    const clipFromWorld = new Matrix4()
        .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
        .multiply(worldFromRoot);
    const eye = new Vector3();
    if (camera.isOrthographicCamera)
        eye.set(0, 0, 1).transformDirection(camera.matrixWorld).transformDirection(rootFromWorld);
    else eye.setFromMatrixPosition(camera.matrixWorld).applyMatrix4(rootFromWorld);
    // Of the whole height; 0 where the rays are parallel.
    const radians = camera.isOrthographicCamera ? 0 : 2 * Math.atan(1 / camera.projectionMatrix.elements[5]);
    return {
        clipFromWorld: clipFromWorld.elements,
        worldFromClip: clipFromWorld.clone().invert().elements,
        radians,
        eye: eye.toArray(),
        eyeAtInfinity: camera.isOrthographicCamera ? 1 : 0,
    };
}

// What is drawn of a bake: whether a mesh of its own is, and copies.
function surfacesOf(light, scene, camera) {
    const isDrawn = (mesh) => light.enabled && camera.layers.test(mesh.layers),
        copies = [];
    findCopies(scene, light.bake.surfaces.drawRanges, (mesh, range, worldFromRoot) => {
        if (isDrawn(mesh)) copies.push({ mesh, range, ...viewOf(worldFromRoot, camera) });
    });
    return { isVisible: (mesh) => isDrawn(mesh) && isVisible(mesh, scene), copies };
}

export class Rendering {
    constructor(renderer) {
        this.renderer = renderer;
        this.passes = null;
        this.drawnFor = null;
        // What was made in the lost context is gone with it.
        this.onRestored = () => {
            this.passes = null;
            this.drawnFor = null;
        };
        renderer.domElement.addEventListener('webglcontextrestored', this.onRestored);
    }

    // Draws the passes in the middle of a call of `renderer.render`, and leaves it as it was. Nothing is
    // drawn where nothing has changed: the light is that of a call, a camera, and a target (three.js draws
    // what is behind glass into another one first). Returns { targets, corner }, the pictures and where they
    // are in the target, or null.
    draw(light, scene, camera) {
        const { renderer } = this,
            gl = renderer.getContext(),
            target = renderer.getRenderTarget(),
            { frame } = renderer.info.render,
            last = this.drawnFor;
        if (gl.isContextLost()) return null;
        if (last?.frame === frame && last.camera === camera && last.target === target) return last.shown;
        // The cameras of an ArrayCamera have viewports of their own.
        const viewport = camera.viewport ?? renderer.getCurrentViewport(new Vector4());
        const [x, y, width, height] = viewport.toArray().map(Math.floor);
        if (width < 1 || height < 1) return null;
        const face = renderer.getActiveCubeFace(),
            level = renderer.getActiveMipmapLevel(),
            clearColor = gl.getParameter(gl.COLOR_CLEAR_VALUE);
        try {
            this.passes ??= new Passes(renderer, light.bake);
            this.passes.useLookup(light.bake.lookup);
            const { radians, ...view } = viewOf(light.root.matrixWorld, camera);
            const part = scissoredPart(renderer, [x, y]);
            Object.assign(view, { pixelRadians: radians / height, width, height, part }, surfacesOf(light, scene, camera));
            view.occluders = light.occluders;
            const targets = this.passes.draw(view, light);
            light.isWhole = this.passes.isWhole();
            light.tracedMilliseconds = this.passes.rays.milliseconds;
            this.drawnFor = { frame, camera, target, shown: { targets, corner: [x, y] } };
        } finally {
            renderer.resetState();
            renderer.setRenderTarget(target, face, level);
            renderer.state.viewport(viewport);
            // renderer.clear takes the colour that was set last.
            gl.clearColor(...clearColor);
        }
        return this.drawnFor.shown;
    }

    dispose() {
        this.passes?.dispose();
        this.passes = null;
        this.renderer.domElement.removeEventListener('webglcontextrestored', this.onRestored);
    }
}
