// What stands for meshes where they throw contact shadows, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BoxGeometry, Mesh, MeshStandardMaterial, Object3D, SphereGeometry, Vector3 } from 'three';
import { kMaxOccluders, Occluders } from '../src/occluders.js';

const meshOf = (geometry, options) => new Mesh(geometry, new MeshStandardMaterial(options));

// twin: occlusionBy in src/core/scene/occluders.h.
function shadowsAlong(rows, count, direction) {
    const { x, y, z } = direction.clone().normalize();
    return Array.from({ length: count }, (_, i) => {
        const [, , , xx, yy, zz, xy, xz, yz] = rows.slice(12 * i, 12 * (i + 1));
        return Math.sqrt(xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z));
    });
}
const isNear = (found, wanted, error) => assert.ok(Math.abs(found - wanted) <= error, `${found}, not ${wanted}`);
const directions = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(1, 2, -3), new Vector3(-1, 1, 1)];

test('a sphere stands for itself, where and as large as it is in the room', () => {
    const root = new Object3D(),
        ball = meshOf(new SphereGeometry(0.5, 64, 48)),
        occluders = new Occluders();
    root.position.set(5, 0, 0);
    root.scale.setScalar(2);
    ball.position.set(1, 2, 3);
    ball.rotation.set(0.3, 1, 0);
    ball.scale.setScalar(0.5);
    for (const object of [root, ball]) object.updateMatrixWorld();
    occluders.set([ball]);
    const { count, rows } = occluders.in(root);
    assert.equal(count, 1);
    [-2, 1, 1.5].forEach((x, i) => isNear(rows[i], x, 1e-3));
    const shadow = Math.PI * 0.125 ** 2;
    for (const direction of directions) isNear(shadowsAlong(rows, 1, direction)[0], shadow, 0.01 * shadow);
    ball.visible = false;
    assert.equal(occluders.in(root).count, 0);
});

test('a plate that a node has turned and stretched has the shadow of an ellipsoid', () => {
    const plate = meshOf(new BoxGeometry(1, 0.001, 1)),
        occluders = new Occluders();
    plate.scale.set(2, 1, 1);
    plate.rotation.set(0, 0, 0.7);
    plate.updateMatrixWorld();
    occluders.set([plate]);
    const { count, rows } = occluders.in(new Object3D()),
        sumAlong = (direction) => shadowsAlong(rows, count, direction).reduce((a, b) => a + b);
    isNear(sumAlong(new Vector3(0, 1, 0).applyEuler(plate.rotation)), 2 * Math.sqrt(0.75), 0.01);
    assert.ok(sumAlong(new Vector3(1, 0, 0).applyEuler(plate.rotation)) < 0.1);
});

test('there are never too many, and none of what is seen through', () => {
    const occluders = new Occluders(),
        plates = Array.from({ length: 50 }, () => meshOf(new BoxGeometry(1, 0.01, 1)));
    occluders.set(plates);
    assert.equal(occluders.in(new Object3D()).count, kMaxOccluders);
    occluders.set([meshOf(new BoxGeometry(), { transparent: true })]);
    assert.equal(occluders.in(new Object3D()).count, 0);
});
