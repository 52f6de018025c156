// Functions that three.js calls on its objects, shared with whoever sets them, before or later.

// Puts `wrap(own)` in place of the function `name` of an object, and of each that is assigned to it later. Returns a
// function that undoes it.
export function chainHook(object, name, wrap) {
    let own = object[name],
        wrapped = wrap(own);
    Object.defineProperty(object, name, {
        configurable: true,
        enumerable: true,
        get: () => wrapped,
        set: (later) => {
            own = later;
            wrapped = wrap(later);
        },
    });
    return () => {
        delete object[name];
        if (object[name] !== own) object[name] = own;
    };
}

// Lets `edit` change the shaders of a material, after hooks of others have; `key()` tells the results of edits apart.
// Returns a function that undoes it.
export function chainShader(material, key, edit) {
    let isUndone = false;
    const edited = new WeakSet();
    const undo = [
        chainHook(material, 'onBeforeCompile', (own) => {
            const hook = function (shader, renderer) {
                own.call(this, shader, renderer);
                // A hook that calls the one before it brings the edit along.
                if (isUndone || edited.has(shader)) return;
                edited.add(shader);
                edit(shader);
            };
            // By its text three.js tells materials with other hooks apart.
            hook.toString = () => own.toString();
            return hook;
        }),
        chainHook(material, 'customProgramCacheKey', (own) => {
            return function () {
                return isUndone ? own.call(this) : `${key()} ${own.call(this)}`;
            };
        }),
    ];
    material.needsUpdate = true;
    return () => {
        isUndone = true;
        undo.forEach((step) => step());
        material.needsUpdate = true;
    };
}
