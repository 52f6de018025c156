// The settings: variants, materials and the picture.

const kValues = ['roughness', 'metalness', 'color'];
const kTextured = {
    roughness: (m) => m.roughnessMap,
    metalness: (m) => m.metalnessMap,
    color: (m) => m.map,
};

function createMaterials(host, signal) {
    const { viewer, words } = host,
        material = host.find('material'),
        inputs = kValues.map((id) => host.find(id)),
        chosen = () => viewer.materials[material.value];
    // Those of a variant come when it is chosen.
    const list = () => {
        const { value } = material,
            names = viewer.materials.map(({ name }, i) => name || words('materialNumber', { number: i + 1 }));
        material.replaceChildren(...names.map((name, i) => new Option(name, i)));
        material.value = value;
    };
    const show = () => {
        list();
        for (const { id, labels } of inputs)
            labels[0].textContent = kTextured[id](chosen()) ? words('timesTexture', { name: words(id) }) : words(id);
        for (const input of inputs)
            input.value = input.id === 'color' ? `#${chosen().color.getHexString()}` : chosen()[input.id];
    };
    material.addEventListener('change', show);
    for (const input of inputs) {
        input.addEventListener('input', () => {
            if (input.id === 'color') chosen().color.set(input.value);
            else chosen()[input.id] = Number(input.value);
            viewer.changed();
        });
    }
    host.find('reset').addEventListener('click', () => {
        const { roughness, metalness, color } = viewer.asBaked.get(chosen());
        Object.assign(chosen(), { roughness, metalness });
        chosen().color.copy(color);
        show();
        viewer.changed();
    });
    list();
    // A metal shows the effect of the sliders best.
    material.value = Math.max(
        0,
        viewer.materials.findIndex((m) => m.metalness > 0.5 && !m.metalnessMap),
    );
    host.find('materials').disabled = viewer.materials.length === 0;
    if (viewer.materials.length === 0) return;
    show();
    for (const name of ['material-change', 'variant-applied']) host.addEventListener(name, show, { signal });
}

function createVariants(host, signal) {
    const { words } = host;
    const choices = [{ name: null, color: 'transparent' }, ...host.variants].map(({ name, color }) => {
        const button = document.createElement('button'),
            swatch = document.createElement('span');
        button.type = 'button';
        swatch.className = 'swatch';
        swatch.style.background = color;
        button.append(swatch, name ?? words('asInFile'));
        button.addEventListener('click', () => {
            host.variantName = name;
        });
        return { name, button };
    });
    const show = () => choices.forEach(({ name, button }) => button.setAttribute('aria-pressed', name === host.variantName));
    host.find('swatches').append(...choices.map(({ button }) => button));
    host.find('variants').hidden = choices.length === 1;
    host.addEventListener('variant-applied', show, { signal });
    show();
}

// `signal`: ends what listens to the viewer.
export function createPanel(host, signal) {
    const { viewer } = host,
        [quality, exposure] = ['quality', 'exposure'].map((id) => host.find(id));
    createVariants(host, signal);
    createMaterials(host, signal);
    quality.value = viewer.quality;
    quality.addEventListener('change', () => {
        host.quality = quality.value;
    });
    exposure.value = viewer.exposure;
    exposure.addEventListener('input', () => {
        host.exposure = exposure.value;
    });
    const loadLamps = async () => (await import('./lamp_panel.js')).createLampPanel(host);
    host.find('settings').addEventListener('click', loadLamps, { once: true });
}
