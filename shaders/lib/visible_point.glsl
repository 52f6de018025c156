// The point of a surface that a pixel shows: where it is, in the scene and in the atlas. Reads no material.

in vec3 vPosition;
in vec4 vTexel;
flat in uvec2 vCharts;

uniform vec3 eyeWorld;
uniform float eyeAtInfinity;

struct VisiblePoint {
    vec3 towardEye;        // world
    vec3 normalGeometric;  // world, of the flat triangle, on the eye's side
    vec2 texel;            // position in the atlas, in texels
    uint chart;
};

// pre: not behind a discard, for it needs the pixels beside.
VisiblePoint visiblePoint() {
    VisiblePoint p;
    p.towardEye = normalize(eyeWorld - vPosition * (1.0 - eyeAtInfinity));
    // Derivatives give the flat triangle's plane without another attribute.
    p.normalGeometric = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
    if (dot(p.normalGeometric, p.towardEye) < 0.0) p.normalGeometric = -p.normalGeometric;
    p.chart = gl_FrontFacing ? vCharts.x : vCharts.y;
    p.texel = gl_FrontFacing ? vTexel.xy : vTexel.zw;
    return p;
}
