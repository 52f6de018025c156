// Material variants of a file (KHR_materials_variants). Loaded where it has any.
import { prepareLights } from '../src/index.js';

const kName = 'KHR_materials_variants';

export class Variants {
    constructor(viewer, { scene, parser }) {
        Object.assign(this, { viewer, parser, meshes: [] });
        this.names = (parser.json.extensions[kName].variants ?? []).map(({ name }, i) => name || `${i + 1}`);
        scene.traverse((mesh) => {
            const of = mesh.isMesh && parser.associations.get(mesh);
            const primitive = of && parser.json.meshes[of.meshes]?.primitives[of.primitives ?? 0],
                mappings = primitive?.extensions?.[kName]?.mappings;
            if (mappings) this.meshes.push({ mesh, mappings, own: mesh.material });
        });
    }

    // The base colour of the first material that a variant brings, as CSS has it.
    get swatches() {
        const { materials } = this.parser.json;
        return this.names.map((name, i) => {
            const mapping = this.meshes.flatMap(({ mappings }) => mappings).find(({ variants }) => variants.includes(i)),
                [r, g, b] = materials[mapping?.material]?.pbrMetallicRoughness?.baseColorFactor ?? [1, 1, 1];
            return { name, color: `color(srgb-linear ${r} ${g} ${b})` };
        });
    }

    // Returns whether it could: null is what the file shows, an unknown name changes nothing. The last call counts.
    async apply(name) {
        const variant = this.names.indexOf(name);
        if (variant < 0 && name !== null) return false;
        this.chosen = name;
        const chosen = await Promise.all(
            this.meshes.map(async ({ mesh, mappings, own }) => {
                const mapping = mappings.find(({ variants }) => variants.includes(variant));
                return { mesh, own, loaded: mapping && (await this.parser.getDependency('material', mapping.material)) };
            }),
        );
        if (this.chosen !== name) return false;
        for (const { mesh, own, loaded } of chosen) this.assign(mesh, own, loaded);
        prepareLights(this.viewer.renderer, this.viewer.scene); // shadows of materials that there were not before
        this.viewer.changed();
        return true;
    }

    // three.js makes the material that fits to the mesh's vertices.
    assign(mesh, own, loaded) {
        mesh.material = loaded ?? own;
        if (!loaded) return;
        this.parser.assignFinalMaterial(mesh);
        const { material } = mesh,
            { viewer } = this;
        if (!material.isMeshStandardMaterial || viewer.materials.includes(material)) return;
        viewer.light.adopt(material);
        viewer.addMaterial(material);
    }
}
