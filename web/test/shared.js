// What is dear to make is made once for all test files that run in one process.

// A function of a key: the first call makes the value, later ones get the same. Each caller gives it back by
// `dispose`; the last one's ends it.
export function shared(make, end) {
    const held = new Map();
    return async (key) => {
        if (!held.has(key)) held.set(key, { value: make(key), users: 0 });
        const entry = held.get(key);
        ++entry.users;
        const value = await entry.value;
        const dispose = async () => {
            if (--entry.users > 0) return;
            held.delete(key);
            await end(value);
        };
        return { value, dispose };
    };
}
