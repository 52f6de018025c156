// The file of a room, and what draws it.
import { LinearSRGBColorSpace, ShaderChunk, WebGLRenderer } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { PhatexturesExtension, isSupported } from '../src/index.js';
import { chainShader } from '../src/hooks.js';

export function createRenderer(canvas, context) {
    if (!isSupported(context)) throw new Error('This room needs WebGL 2.');
    const renderer = new WebGLRenderer({ canvas, context });
    renderer.outputColorSpace = LinearSRGBColorSpace; // present.frag encodes
    renderer.shadowMap.autoUpdate = false;
    return renderer;
}

export function loadRoom(url, onProgress) {
    const loader = new GLTFLoader();
    loader.register((parser) => new PhatexturesExtension(parser));
    return loader.loadAsync(url, onProgress);
}

// Four things that three.js does to punctual light, and glTF and hence the bake do not: a highlight is blunted where
// normals turn within a pixel (here many pictures are averaged), and brightened on rough metals for light that would
// be reflected twice; a light nearer than 10 cm counts as that far; and spots have another profile.
function keepToGltf(material) {
    const edits = [
        ['lights_physical_fragment', /.* \+= geometryRoughness;/g, ''],
        [
            'lights_pars_begin',
            'pow( lightDistance, decayExponent ), 0.01',
            'pow( lightDistance, decayExponent ), 1e-30',
        ],
        [
            'lights_pars_begin',
            'smoothstep( coneCosine, penumbraCosine, angleCosine )',
            'pow2( saturate( ( angleCosine - coneCosine ) / max( penumbraCosine - coneCosine, 1e-3 ) ) )',
        ],
        ['lights_fragment_begin', /(multiScatteringCompensation =).*;/g, '$1 vec3(1.0);'],
    ];
    chainShader(material, () => 'keepToGltf', (shader) => {
        for (const [name] of edits)
            shader.fragmentShader = shader.fragmentShader.replace(`#include <${name}>`, ShaderChunk[name]);
        for (const [, pattern, by] of edits) shader.fragmentShader = shader.fragmentShader.replaceAll(pattern, by);
    });
}

// Makes a material of the file's look as it does in the bake.
export function prepareMaterial(material, renderer) {
    const anisotropy = Math.min(8, renderer.capabilities.getMaxAnisotropy()); // twin: mostAnisotropy
    for (const texture of Object.values(material)) if (texture?.isTexture) Object.assign(texture, { anisotropy });
    keepToGltf(material);
}
