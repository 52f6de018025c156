// Why a room cannot be shown, in one sentence. Loaded where one cannot.

const kMilliseconds = 20_000;
const kGltfMagic = 0x46546c67,
    kGlbHeader = 20; // with that of the first chunk

// What is wrong, by the name of its sentence (strings/en.js).
class Cause {
    constructor(name, values) {
        Object.assign(this, { name, values });
    }
}

function nameOf(url) {
    return new URL(url, location.href).pathname.split('/').pop();
}

// What keeps this browser from drawing baked light; nothing if it can.
function lackOfBrowser(context) {
    if (!context || typeof WebGL2RenderingContext === 'undefined') return 'noWebGl';
    if (!context.getExtension('EXT_color_buffer_float')) return 'noFloats';
    if (typeof DecompressionStream === 'undefined') return 'noDecompression';
    return '';
}

// The bytes of a file; throws a Cause.
async function fetchWhole(url) {
    const name = nameOf(url),
        signal = AbortSignal.timeout(kMilliseconds);
    let response;
    try {
        response = await fetch(url, { signal });
    } catch {
        throw new Cause(navigator.onLine ? 'unreachable' : 'offline', { name });
    }
    if (!response.ok) throw new Cause('status', { name, status: `${response.status} ${response.statusText}`.trim() });
    if (/html/.test(response.headers.get('content-type'))) throw new Cause('webPage', { name });
    try {
        return await response.arrayBuffer();
    } catch {
        throw new Cause('broken', { name });
    }
}

function requireLength(url, { byteLength }, expected) {
    if (byteLength < expected) throw new Cause('cutOff', { name: nameOf(url), has: byteLength, expected });
}

// Its other files with their lengths; throws a Cause.
async function partsOf(room) {
    const bytes = await fetchWhole(room),
        view = new DataView(bytes);
    requireLength(room, bytes, kGlbHeader);
    if (view.getUint32(0, true) !== kGltfMagic) throw new Cause('noRoom', { name: nameOf(room) });
    requireLength(room, bytes, view.getUint32(8, true));
    const json = new TextDecoder().decode(new Uint8Array(bytes, kGlbHeader, view.getUint32(12, true)));
    return JSON.parse(json)
        .buffers.filter(({ uri }) => uri)
        .map(({ uri, byteLength }) => ({ url: new URL(uri, new URL(room, location.href)).href, byteLength }));
}

// `error`: what was thrown; `room`: the file's address; `context`: what its canvas gave, undefined if not asked.
export async function causeOf({ error, room, context }, words) {
    const lack = context === undefined ? '' : lackOfBrowser(context);
    if (lack) return words(lack);
    try {
        for (const { url, byteLength } of await partsOf(room)) requireLength(url, await fetchWhole(url), byteLength);
    } catch (cause) {
        if (cause instanceof Cause) return words('cannotLoad', { cause: words(cause.name, cause.values) });
    }
    return words('cannotLoad', { cause: error.message });
}
