// What a tap of the picture is, and what it points at.
import { Raycaster, Vector2 } from 'three';

export const kTapPixels = 6; // a pointer that moves farther does not tap

// From the eye through a point of the browser's window.
export function rayThrough({ clientX, clientY }, canvas, camera) {
    const { left, top, width, height } = canvas.getBoundingClientRect(),
        ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height), camera);
    return ray;
}
