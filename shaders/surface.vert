// A corner of a triangle, for every pass that draws the scene.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 uv0;
layout(location = 4) in vec2 uv1;
layout(location = 5) in vec4 color;
layout(location = 6) in vec2 texelFront;  // atlas texels of the triangle's two sides
layout(location = 7) in vec2 texelBack;
layout(location = 8) in uvec2 charts;     // front, back

uniform mat4 clipFromWorld;

out vec3 vPosition;
out vec3 vNormal;
out vec4 vTangent;
out vec4 vUv;  // uv0, uv1
out vec4 vColor;
out vec4 vTexel;  // front, back
flat out uvec2 vCharts;
flat out uint vTriangle;

// The depth pass and the display pass must agree to the last bit.
invariant gl_Position;

void main() {
    gl_Position = clipFromWorld * vec4(position, 1.0);
    vPosition = position;
    vNormal = normal;
    vTangent = tangent;
    vUv = vec4(uv0, uv1);
    vColor = color;
    vTexel = vec4(texelFront, texelBack);
    vCharts = charts;
    vTriangle = uint(gl_VertexID) / 3u;  // vertices are not shared
}
