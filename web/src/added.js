// Meshes that were not in the bake, lit by its probes instead of ambient, hemisphere and environment light.
import { Matrix4 } from 'three';
import { shaderLibrary } from './gl.js';
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

function injectProbes(material, uniforms) {
    const { onBeforeCompile, customProgramCacheKey } = material;
    material.onBeforeCompile = function (shader, renderer) {
        onBeforeCompile.call(this, shader, renderer);
        Object.assign(shader.uniforms, uniforms);
        shader.vertexShader = vertexDeclarations + shader.vertexShader.replace('#include <project_vertex>', place);
        shader.fragmentShader =
            shaderLibrary('lib/probe_light.glsl') +
            fragmentDeclarations +
            shader.fragmentShader.replace('#include <lights_fragment_end>', light);
    };
    material.customProgramCacheKey = function () {
        return `phat probes ${customProgramCacheKey.call(this)}`;
    };
    material.needsUpdate = true;
    return () => {
        Object.assign(material, { onBeforeCompile, customProgramCacheKey });
        material.needsUpdate = true;
    };
}

// What a BakedLight has added.
export class AddedMeshes {
    constructor(root, parser, description) {
        this.root = root;
        this.read = () => readProbes(parser, description);
        this.rootFromWorld = { value: new Matrix4() };
        this.materials = new Map(); // undo and number of meshes
        this.meshes = new Map(); // undo
    }

    async add(object) {
        this.reading ??= this.read();
        this.uniforms = { ...(await this.reading), phatRootFromWorld: this.rootFromWorld };
        if (this.disposed) return;
        object.traverse((mesh) => {
            if (mesh.isMesh && !this.meshes.has(mesh)) this.addMesh(mesh);
        });
    }

    addMesh(mesh) {
        const { onBeforeRender } = mesh,
            materials = [mesh.material].flat();
        mesh.onBeforeRender = (...all) => {
            onBeforeRender.apply(mesh, all);
            this.rootFromWorld.value.copy(this.root.matrixWorld).invert();
        };
        for (const material of materials) {
            const known = this.materials.get(material) ?? {
                undo: injectProbes(material, this.uniforms),
                count: 0,
            };
            ++known.count;
            this.materials.set(material, known);
        }
        this.meshes.set(mesh, () => {
            mesh.onBeforeRender = onBeforeRender;
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
    }

    dispose() {
        this.disposed = true;
        this.meshes.forEach((undo) => undo());
        this.meshes.clear();
        if (!this.uniforms) return;
        const { probeCells, probeLight, probeDistances } = this.uniforms;
        for (const { value } of [probeCells, probeLight, probeDistances]) value.dispose();
    }
}
