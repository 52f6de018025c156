// A page that frames this one may change the view by messages, and is told what happens. docs/hosting.md describes them.

// What a message may set.
const kSettable = ['camera', 'exposure', 'quality', 'mode', 'variantName', 'view'];
const kTold = ['load', 'progress', 'error', 'camera-change', 'variant-applied'];

export function answerMessages(room) {
    // Nothing that is told is secret, and the framing page's address is not known.
    const tell = (message) => parent.postMessage({ phatViewer: message }, '*');
    const stateOf = () => ({
        availableVariants: room.availableVariants,
        viewpoints: room.viewpoints,
        materials: room.materials,
        ...Object.fromEntries(kSettable.map((name) => [name, room[name]])),
    });
    for (const name of kTold)
        room.addEventListener(name, ({ detail: { sourceError, ...detail } }) =>
            tell({ event: name, detail, ...(name !== 'progress' && { state: stateOf() }) }),
        );
    addEventListener('message', ({ source, data }) => {
        if (source !== parent || typeof data?.phatViewer !== 'object') return;
        const { set = {}, material } = data.phatViewer;
        try {
            for (const name of kSettable) if (name in set) room[name] = set[name];
            if (material) room.setMaterial(material.name, material);
        } catch (error) {
            tell({ event: 'error', detail: { type: 'message', message: error.message } });
        }
    });
}
