// Meshes that were not in the bake, lit by its probes instead of ambient, hemisphere and environment light.
// Few pages add any: it is loaded by the first that are.
import { Matrix4 } from 'three';
import shaders from 'phat:probe-shaders';
import { addShaders, shaderLibrary } from './gl.js';
import { chainHook, chainShader } from './hooks.js';
import { Occluders } from './occluders.js';
import { addPhotometry, photometryKey } from './photometry.js';
import { readProbes } from './probes.js';

const vertexDeclarations = `
uniform mat4 phatRootFromWorld;
varying vec3 vPhatPosition;
`;
const place = `#include <project_vertex>
vec4 phatPosition = vec4(transformed, 1.0);
#ifdef USE_BATCHING
phatPosition = batchingMatrix * phatPosition;
#endif
#ifdef USE_INSTANCING
phatPosition = instanceMatrix * phatPosition;
#endif
vPhatPosition = (phatRootFromWorld * modelMatrix * phatPosition).xyz;
`;

const fragmentDeclarations = `
uniform mat4 phatRootFromWorld;
varying vec3 vPhatPosition;
vec3 phatRootDirection(vec3 view) {
    return normalize(mat3(phatRootFromWorld) * (view * mat3(viewMatrix)));
}
`;
// Materials with GGX have their diffuse part by the same function as their glossy one.
const light = `
#ifdef RE_IndirectDiffuse
{
    vec3 phatNormals[2] = vec3[2](phatRootDirection(normal), phatRootDirection(reflect(-geometryViewDir, normal)));
    ProbeIrradiance phat = probeIrradiance(vPhatPosition, phatNormals);
    irradiance = phat.indirect[0] + phat.area[0];
#ifdef RE_IndirectSpecular
    iblIrradiance = irradiance;
    irradiance = vec3(0.0);
    radiance = (phat.indirect[1] + phat.area[1]) * RECIPROCAL_PI;
    clearcoatRadiance = radiance;
#endif
}
#endif
#include <lights_fragment_end>
`;

addShaders(shaders);

function injectProbes(material, uniforms) {
    const key = () => `phat probes${photometryKey()}`;
    return chainShader(material, key, (shader) => {
        Object.assign(shader.uniforms, uniforms);
        addPhotometry(shader);
        shader.vertexShader = vertexDeclarations + shader.vertexShader.replace('#include <project_vertex>', place);
        shader.fragmentShader =
            shaderLibrary('lib/probe_light.glsl') +
            fragmentDeclarations +
            shader.fragmentShader.replace('#include <lights_fragment_end>', light);
    });
}

// What a BakedLight has added.
export class AddedMeshes {
    // `probes`: what readProbes returns.
    constructor(root, probes) {
        this.root = root;
        this.rootFromWorld = { value: new Matrix4() };
        this.uniforms = { ...probes, phatRootFromWorld: this.rootFromWorld };
        this.materials = new Map(); // undo and number of meshes
        this.meshes = new Map(); // undo
        this.occluders = new Occluders();
    }

    static async read(root, parser, description) {
        return new AddedMeshes(root, await readProbes(parser, description));
    }

    add(object) {
        object.traverse((mesh) => {
            if (mesh.isMesh && !this.meshes.has(mesh)) this.addMesh(mesh);
        });
        this.occluders.set([...this.meshes.keys()]);
    }

    addMesh(mesh) {
        const materials = [mesh.material].flat();
        const undo = chainHook(mesh, 'onBeforeRender', (own) => (...all) => {
            own.apply(mesh, all);
            this.rootFromWorld.value.copy(this.root.matrixWorld).invert();
        });
        for (const material of materials) {
            const known = this.materials.get(material) ?? {
                undo: injectProbes(material, this.uniforms),
                count: 0,
            };
            ++known.count;
            this.materials.set(material, known);
        }
        this.meshes.set(mesh, () => {
            undo();
            for (const material of materials) {
                const known = this.materials.get(material);
                if (--known.count > 0) continue;
                known.undo();
                this.materials.delete(material);
            }
        });
    }

    remove(object) {
        object.traverse((mesh) => {
            this.meshes.get(mesh)?.();
            this.meshes.delete(mesh);
        });
        this.occluders.set([...this.meshes.keys()]);
    }

    // Frees what is on the GPU; three.js uploads it again where it is drawn again.
    dispose() {
        const { probeCells, probeLight, probeDistances } = this.uniforms;
        for (const { value } of [probeCells, probeLight, probeDistances]) value.dispose();
    }

    detach() {
        this.meshes.forEach((undo) => undo());
        this.meshes.clear();
        this.occluders.set([]);
        this.dispose();
    }
}
