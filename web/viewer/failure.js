// Why a room cannot be shown, in one sentence. Loaded where one cannot.

const kMilliseconds = 20_000;
const kGltfMagic = 0x46546c67,
    kGlbHeader = 20; // with that of the first chunk

function nameOf(url) {
    return new URL(url, location.href).pathname.split('/').pop();
}

// What keeps this browser from drawing baked light; nothing if it can.
function lackOfBrowser(context) {
    if (!context || typeof WebGL2RenderingContext === 'undefined')
        return 'This room needs WebGL 2, which this browser or device does not offer, or which is switched off.';
    if (!context.getExtension('EXT_color_buffer_float'))
        return 'This room needs WebGL 2 with float render targets, which this browser or device does not offer.';
    if (typeof DecompressionStream === 'undefined')
        return 'This room needs a newer browser, with DecompressionStream (Chrome 80, Firefox 113, Safari 16.4).';
    return '';
}

// The bytes of a file; throws a sentence.
async function fetchWhole(url) {
    const name = nameOf(url),
        signal = AbortSignal.timeout(kMilliseconds);
    let response;
    try {
        response = await fetch(url, { signal });
    } catch {
        throw navigator.onLine
            ? `The server cannot be reached for ${name}, or does not allow this page to load it.`
            : `This device is offline: ${name} cannot be loaded.`;
    }
    if (!response.ok) throw `The server answers ${response.status} ${response.statusText} for ${name}.`;
    if (/html/.test(response.headers.get('content-type'))) throw `The server sends a web page in place of ${name}.`;
    try {
        return await response.arrayBuffer();
    } catch {
        throw `The connection broke while ${name} was loaded.`;
    }
}

function requireLength(url, { byteLength }, expected) {
    if (byteLength < expected) throw `${nameOf(url)} is cut off: it has ${byteLength} of ${expected} bytes.`;
}

// Its other files with their lengths; throws a sentence.
async function partsOf(room) {
    const bytes = await fetchWhole(room),
        view = new DataView(bytes);
    requireLength(room, bytes, kGlbHeader);
    if (view.getUint32(0, true) !== kGltfMagic) throw `What the server sends as ${nameOf(room)} is not a room.`;
    requireLength(room, bytes, view.getUint32(8, true));
    const json = new TextDecoder().decode(new Uint8Array(bytes, kGlbHeader, view.getUint32(12, true)));
    return JSON.parse(json)
        .buffers.filter(({ uri }) => uri)
        .map(({ uri, byteLength }) => ({ url: new URL(uri, new URL(room, location.href)).href, byteLength }));
}

// `error`: what was thrown; `room`: the file's address; `context`: what its canvas gave, undefined if not asked.
export async function causeOf({ error, room, context }) {
    const lack = context === undefined ? '' : lackOfBrowser(context);
    if (lack) return lack;
    try {
        for (const { url, byteLength } of await partsOf(room)) requireLength(url, await fetchWhole(url), byteLength);
    } catch (cause) {
        if (typeof cause === 'string') return `The room could not be loaded: ${cause}`;
    }
    return `The room could not be loaded: ${error.message}`;
}
