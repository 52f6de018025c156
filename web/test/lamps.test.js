// The lamps of a room, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Mesh, MeshStandardMaterial, Object3D, PointLight } from 'three';
import { lampsOf } from '../src/lamps.js';

const rangeOf = (name, emissive, emissiveIntensity) => ({
    mesh: new Mesh(undefined, new MeshStandardMaterial({ name, emissive, emissiveIntensity })),
});

test('lamps that are off in the file can be switched on, where the bake has a layer for their light', () => {
    const off = rangeOf('off', '#ff8000', 0),
        drawRanges = [rangeOf('on', 'white', 4), off, rangeOf('wall', 'black', 1)],
        root = new Object3D(),
        bulb = Object.assign(new PointLight('white', 0), { name: 'bulb' });
    root.add(bulb);
    const namesOf = (lamps) => lamps.map(({ name }) => name);
    assert.deepEqual(namesOf(lampsOf(root, { drawRanges, hasArea: false }, () => {})), ['bulb', 'on']);
    let changes = 0;
    const lamps = lampsOf(root, { drawRanges, hasArea: true }, () => ++changes);
    assert.deepEqual(namesOf(lamps), ['bulb', 'on', 'off']);
    assert.deepEqual(
        lamps.map(({ visible }) => visible),
        [false, true, false],
    );
    const { material } = off.mesh;
    Object.assign(lamps[2], { intensity: 6, visible: true });
    assert.equal(material.emissiveIntensity, 6);
    assert.equal(material.emissive.getHexString(), 'ff8000');
    lamps[0].visible = true;
    assert.equal(bulb.intensity, 1);
    assert.equal(changes, 3);
    lamps.forEach((lamp) => lamp.reset());
    assert.deepEqual([material.emissiveIntensity, bulb.intensity, lamps[2].visible, lamps[1].visible], [0, 0, false, true]);
});
