// The material panel and the picture's settings.

const kNames = { roughness: 'Roughness', metalness: 'Metalness', color: 'Colour' };

const element = (id) => document.getElementById(id);

// `changed` is called when the picture is another one; `viewer`: see viewer.js.
export function createPanel(viewer, materials, cameras, goTo, changed) {
    const baked = new Map(
        materials.map((m) => [m, { roughness: m.roughness, metalness: m.metalness, color: m.color.clone() }]),
    );
    const material = element('material'),
        inputs = ['roughness', 'metalness', 'color'].map(element);
    const named = (names, select) => select.append(...names.map((name, i) => new Option(name, i)));
    named(
        materials.map((m, i) => m.name || `Material ${i + 1}`),
        material,
    );
    named(
        cameras.map((c, i) => c.name || `Camera ${i + 1}`),
        element('camera'),
    );
    const chosen = () => materials[material.value];
    const isTextured = {
        roughness: (m) => m.roughnessMap,
        metalness: (m) => m.metalnessMap,
        color: (m) => m.map,
    };
    const show = () => {
        for (const { id, labels } of inputs)
            labels[0].textContent = kNames[id] + (isTextured[id](chosen()) ? ' × texture' : '');
        for (const input of inputs)
            input.value = input.id === 'color' ? `#${chosen().color.getHexString()}` : chosen()[input.id];
    };
    material.addEventListener('change', show);
    for (const input of inputs) {
        input.addEventListener('input', () => {
            if (input.id === 'color') chosen().color.set(input.value);
            else chosen()[input.id] = Number(input.value);
            changed();
        });
    }
    element('reset').addEventListener('click', () => {
        const { roughness, metalness, color } = baked.get(chosen());
        Object.assign(chosen(), { roughness, metalness });
        chosen().color.copy(color);
        show();
        changed();
    });
    element('camera').addEventListener('change', (event) => goTo(cameras[event.target.value]));
    element('wipe').addEventListener('input', (event) => {
        viewer.light.wipe = Number(event.target.value);
        changed();
    });
    element('quality').addEventListener('change', (event) => {
        viewer.quality = event.target.value;
        changed();
    });
    element('exposure').addEventListener('input', (event) => {
        viewer.exposure = Number(event.target.value);
        viewer.present();
    });
    element('exposure').value = viewer.exposure;
    // A metal shows the effect of the sliders best.
    material.value = Math.max(
        0,
        materials.findIndex((m) => m.metalness > 0.5 && !m.metalnessMap),
    );
    if (materials.length > 0) show();
    element('controls').disabled = materials.length === 0;
    const loadLamps = async () => (await import('./lamp_panel.js')).createLampPanel(viewer, changed);
    element('panel').addEventListener('toggle', loadLamps, { once: true });
}
