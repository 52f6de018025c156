// The body of who walks: eyes above feet that stand on the floor.
import { MathUtils, Vector3 } from 'three';

// Metres.
export const kWalkPerSecond = 1.4,
    kArrived = 0.05; // so near is there
const kBodyRadius = 0.25, // half of a narrow door's width
    kStep = 0.45, // what is lower than a seat is stepped over
    kFallPerSecond = 2,
    kFar = 100;
const kFloorSlope = 0.7; // a floor's normal points upward at least that much

const down = new Vector3(0, -1, 0);

// Where a ray meets a floor; null: what it meets is none. `ray`: a Raycaster.
export function floorAt(ray, root) {
    const [hit] = ray.intersectObject(root, true);
    const isFloor = hit && hit.face.normal.clone().transformDirection(hit.object.matrixWorld).y >= kFloorSlope;
    return isFloor ? hit.point : null;
}

export class Body {
    // `meter`: see Navigation.
    constructor(walls, meter) {
        Object.assign(this, { walls, meter });
    }

    // The height of the eyes above the feet.
    set eyeHeight(height) {
        const { meter } = this;
        this.height = height;
        this.radius = Math.min(kBodyRadius * meter, height / 2);
        this.depths = [0, height / 3, height - Math.min(kStep * meter, height / 2)];
    }

    get eyeHeight() {
        return this.height;
    }

    // Of eyes above the floor.
    heightOf(eye) {
        return this.walls.distance(eye, down, kFar * this.meter);
    }

    // Where eyes come to that move by `motion`.
    move(eye, motion) {
        return this.walls.move(eye, motion, this);
    }

    // How far the feet come up, or down, to the floor in that time; 0 where they stand on it, or there is none.
    rise(eye, seconds) {
        const height = this.heightOf(eye),
            most = kFallPerSecond * this.meter * seconds,
            rise = MathUtils.clamp(this.eyeHeight - height, -most, most);
        return height >= kFar * this.meter || Math.abs(rise) < 1e-3 * this.meter ? 0 : rise;
    }
}
