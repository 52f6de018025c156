// Rays from the eye through pixels.

uniform mat4 worldFromClip;   // of the whole camera; clip space as it is drawn
uniform vec2 viewport;        // pixels
uniform vec3 eyeWorld;        // or the direction toward it, if it is at infinity
uniform float eyeAtInfinity;

struct ViewRay {
    vec3 origin;
    vec3 direction;  // unit
};

// `matrix`, `eye`: of a camera, as the uniforms.
ViewRay viewRayOf(mat4 matrix, vec3 eye, vec2 pixel) {
    vec4 point = matrix * vec4(pixel / viewport * 2.0 - 1.0, 0.5, 1.0);
    vec3 through = point.xyz / point.w;
    if (eyeAtInfinity > 0.5) return ViewRay(through, -eye);
    return ViewRay(eye, normalize(through - eye));
}

ViewRay viewRay(vec2 pixel) {
    return viewRayOf(worldFromClip, eyeWorld, pixel);
}
