// The ray from the eye through the middle of a pixel.

uniform mat4 worldFromClip;  // of the whole camera; clip space as it is drawn
uniform vec2 viewport;       // pixels
uniform vec3 eyeWorld;       // or the direction toward it, if it is at infinity
uniform float eyeAtInfinity;

struct ViewRay {
    vec3 origin;
    vec3 direction;  // unit
};

ViewRay viewRay(vec2 pixel) {
    vec4 far = worldFromClip * vec4(pixel / viewport * 2.0 - 1.0, 0.5, 1.0);
    vec3 through = far.xyz / far.w;
    if (eyeAtInfinity > 0.5) return ViewRay(through, -eyeWorld);
    return ViewRay(eyeWorld, normalize(through - eyeWorld));
}
