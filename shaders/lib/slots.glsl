// Lookups of a material's textures in the passes that draw the scene.
#include "lib/material.glsl"

uniform vec4 material[kMaterialRows];
uniform sampler2D baseColorTexture;

in vec4 vUv;
in vec4 vColor;

bool slotBound(int slot) {
    return material[slot + 1].w > 0.5;
}

vec2 slotUv(int slot) {
    vec4 u = material[slot], v = material[slot + 1];
    vec3 uv = vec3(u.w < 0.5 ? vUv.xy : vUv.zw, 1.0);
    return vec2(dot(u.xyz, uv), dot(v.xyz, uv));
}

float opacity() {
    return material[0].a * vColor.a * texture(baseColorTexture, slotUv(kSlotBaseColor)).a;
}
