// The view in the page's address, #view=eye;target;fov, so that it can be bookmarked and sent.
import { viewFrom } from './navigation.js';

const kRestMilliseconds = 400; // browsers allow some hundred changes a minute
const kPart = /^view=/;

const partsOf = ({ hash }) => hash.slice(1).split('&').filter(Boolean);

// The view that an address asks for; null if none.
export function viewOfAddress(address = location) {
    const part = partsOf(address).find((each) => kPart.test(each));
    try {
        return part ? viewFrom(decodeURIComponent(part)) : null;
    } catch {
        return null; // a % that encodes nothing
    }
}

export function addressOf(view) {
    const address = new URL(location.href);
    address.hash = [...partsOf(address).filter((each) => !kPart.test(each)), `view=${view}`].join('&');
    return address.href;
}

// Keeps the address up to date with a viewer, and the viewer with an address that is typed in. Returns a function that
// ends it.
export function followAddress(host) {
    let waiting;
    const write = () => {
        clearTimeout(waiting);
        waiting = setTimeout(() => history.replaceState(history.state, '', addressOf(host.view)), kRestMilliseconds);
    };
    const read = () => {
        const view = viewOfAddress();
        if (view) host.viewer.navigation.travel(view);
    };
    host.addEventListener('camera-change', write);
    addEventListener('hashchange', read);
    return () => {
        clearTimeout(waiting);
        host.removeEventListener('camera-change', write);
        removeEventListener('hashchange', read);
    };
}
