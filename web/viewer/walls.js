// What keeps an eye from passing: the room's surfaces, by its trees where they are loaded, else by three.js.
import { Raycaster, Vector3 } from 'three';

const kDirections = 16; // of a circle around a body
const kManyTriangles = 20_000; // more are too slow without trees
const kEnough = 0.9; // of the radius: rays around a circle miss what stands between them

const aroundCircle = Array.from({ length: kDirections }, (_, i) => {
    const angle = (2 * Math.PI * i) / kDirections;
    return new Vector3(Math.cos(angle), 0, Math.sin(angle));
});

export class Walls {
    constructor(root, light) {
        Object.assign(this, { root, light, ray: new Raycaster() });
        this.still = true; // whether all is where it was baked, as the trees have it
    }

    // Before it is asked often.
    prepare() {
        const { light } = this;
        if (light.canTrace && light.bake.surfaces.indices.length / 3 > kManyTriangles) light.loadTrees();
    }

    // Distance to the nearest surface, `far` if there is none before. `direction`: of length 1.
    distance(origin, direction, far) {
        const { trees, tracing } = (this.still && this.light.bake) || {};
        if (trees) {
            if (trees !== this.trees) Object.assign(this, { trees, rays: new tracing.TreeRays(trees) });
            return this.rays.distance(origin.toArray(), direction.toArray(), far);
        }
        this.ray.set(origin, direction);
        this.ray.far = far;
        return this.ray.intersectObject(this.root, true)[0]?.distance ?? far;
    }

    // Whether there are surfaces on all sides of a point, but maybe one.
    encloses(place, far) {
        const axes = [0, 1, 2].flatMap((axis) => [-1, 1].map((sign) => new Vector3().setComponent(axis, sign)));
        return axes.filter((direction) => this.distance(place, direction, far) < far).length >= axes.length - 1;
    }

    isFree(from, to) {
        const way = to.clone().sub(from),
            length = way.length();
        return length === 0 || this.distance(from, way.normalize(), length) >= length;
    }

    // How far a body is from walls, up to its radius, and in which direction. `depths`: heights at which it is wide,
    // below its eye.
    clearance(eye, { radius, depths }) {
        let [least, toward] = [radius, aroundCircle[0]];
        for (const depth of depths) {
            const from = eye.clone();
            from.y -= depth;
            for (const direction of aroundCircle) {
                const distance = this.distance(from, direction, least);
                if (distance < least) [least, toward] = [distance, direction];
            }
        }
        return { least, toward };
    }

    // Where a body comes to that moves by `motion`: along walls, not through them, nor through gaps that are too narrow.
    move(eye, motion, body) {
        this.prepare();
        const steps = Math.max(1, Math.ceil(motion.length() / (body.radius / 2)));
        let at = eye.clone();
        for (let i = 0; i < steps; ++i) {
            const enough = Math.min(kEnough * body.radius, this.clearance(at, body).least);
            const next = at.clone().addScaledVector(motion, 1 / steps);
            for (let push = 0; push < 4; ++push) {
                const { least, toward } = this.clearance(next, body);
                if (least >= kEnough * body.radius) break;
                next.addScaledVector(toward, least - body.radius);
            }
            if (this.clearance(next, body).least < enough || !this.isFree(at, next)) break;
            at = next;
        }
        return at;
    }
}
