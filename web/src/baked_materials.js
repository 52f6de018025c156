// The materials that show a bake's light.
import { ExternalTexture } from 'three';
import { chainHook } from './hooks.js';
import { injectLight } from './inject.js';
import { isBlended } from './material.js';

export class BakedMaterials {
    // `draw(renderer, scene, camera)`: makes the light of a picture before anything is drawn with one of them.
    constructor(draw) {
        this.drawLight = draw;
        this.corner = { value: [0, 0] };
        const pictures = () => ({ light: new ExternalTexture(), depth: new ExternalTexture() });
        this.pictures = { opaque: pictures(), blended: pictures() };
        this.all = new Map();
    }

    // pre: a MeshStandardMaterial.
    adopt(material) {
        if (this.all.has(material)) return;
        const { uniforms, undo } = injectLight(material, this.corner);
        const undoDraw = chainHook(material, 'onBeforeRender', (own) => (renderer, scene, camera, ...rest) => {
            own.call(material, renderer, scene, camera, ...rest);
            this.drawLight(renderer, scene, camera);
        });
        this.all.set(material, { uniforms, undo: [undo, undoDraw], isUnlit: false });
    }

    show({ targets, corner }) {
        this.corner.value = corner;
        for (const kind of ['opaque', 'blended']) {
            this.pictures[kind].light.sourceTexture = targets[kind]?.light ?? null;
            this.pictures[kind].depth.sourceTexture = targets[kind]?.depth ?? null;
        }
        for (const [material, { uniforms }] of this.all) {
            const { light, depth } = this.pictures[isBlended(material) ? 'blended' : 'opaque'];
            uniforms.phatLight.value = light;
            uniforms.phatDepth.value = depth;
            uniforms.phatBehindDepth.value = this.pictures.opaque.depth;
        }
    }

    // Base colours by no light, where that of the bake cannot be drawn.
    showUnlit() {
        for (const [material, entry] of this.all) {
            const { color, emissive, emissiveMap, emissiveIntensity, map } = material;
            if (entry.isUnlit) continue;
            entry.isUnlit = true;
            const shines = emissiveIntensity > 0 && emissive.getHex() > 0;
            if (!shines) Object.assign(material, { emissive: color.clone(), emissiveMap: map, emissiveIntensity: 1 });
            material.color = color.clone().setScalar(0);
            material.needsUpdate = true;
            entry.undo.push(() => Object.assign(material, { color, emissive, emissiveMap, emissiveIntensity }));
        }
    }

    // Frees what three.js made of the pictures.
    dispose() {
        for (const { light, depth } of Object.values(this.pictures))
            [light, depth].forEach((texture) => texture.dispose());
    }

    // The materials are what they were.
    detach() {
        this.all.forEach(({ undo }) => undo.forEach((step) => step()));
        this.all.clear();
        this.dispose();
    }
}
