// What the package's types declare is what its objects have, member by member. Needs no browser.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { MeshStandardMaterial } from 'three';
import ts from 'typescript';
import { Lamp } from '../src/lamps.js';
import { lightOfEnvironment } from './bare_light.js';

const path = (name) => new URL(name, import.meta.url).pathname;
const options = {
    module: ts.ModuleKind.NodeNext,
    moduleResolution: ts.ModuleResolutionKind.NodeNext,
    target: ts.ScriptTarget.ES2022,
    strict: true,
    noEmit: true,
};

const declarations = path('../src/index.d.ts'),
    typed = ts.createProgram([declarations, path('types.ts'), path('../examples/importmap/main.js')], { ...options, checkJs: true }),
    typedChecker = typed.getTypeChecker();
const sources = ['extension.js', 'lamps.js'].map((name) => path(`../src/${name}`)),
    written = ts.createProgram(sources, { ...options, allowJs: true, strict: false }),
    writtenChecker = written.getTypeChecker();

// What a file exports, by name: the type of its instances, where it has any.
function exportsOf(checker, program, file) {
    const module = checker.getSymbolAtLocation(program.getSourceFile(file));
    return new Map(
        checker.getExportsOfModule(module).map((symbol) => [
            symbol.name,
            { symbol, instance: checker.getDeclaredTypeOfSymbol(symbol) },
        ]),
    );
}

// Members by name, but private ones and those for the package's other files.
function publicMembers(checker, instance) {
    const isPublic = (symbol) =>
        !symbol.name.startsWith('#') && !symbol.getJsDocTags(checker).some(({ name }) => name === 'internal');
    return new Map(checker.getPropertiesOfType(instance).filter(isPublic).map((symbol) => [symbol.name, symbol]));
}

const kFunctions = ts.SymbolFlags.Method | ts.SymbolFlags.Function;
const declared = exportsOf(typedChecker, typed, declarations),
    defined = new Map(sources.flatMap((file) => [...exportsOf(writtenChecker, written, file)]));
const typesOf = (name) => publicMembers(typedChecker, declared.get(name).instance);

test('classes have the members that their types declare, and no others', () => {
    for (const name of ['BakedLight', 'Lamp', 'PhatexturesExtension']) {
        const [types, members] = [typesOf(name), publicMembers(writtenChecker, defined.get(name).instance)];
        assert.deepEqual([...types.keys()].sort(), [...members.keys()].sort(), name);
        for (const [member, symbol] of types)
            assert.equal(symbol.flags & kFunctions, members.get(member).flags & kFunctions, `${name}.${member}`);
    }
});

test('the package exports what its types declare', async () => {
    const exported = await import('../dist/phatextures.js'),
        values = [...declared].filter(([, { symbol }]) => symbol.flags & ts.SymbolFlags.Value);
    assert.deepEqual(values.map(([name]) => name).sort(), Object.keys(exported).sort());
    for (const [name, { symbol }] of values) {
        assert.equal(typeof exported[name], 'function');
        if (symbol.flags & ts.SymbolFlags.Class) continue;
        const [signature] = typedChecker.getTypeOfSymbol(symbol).getCallSignatures();
        assert.equal(exported[name].length, signature.parameters.length, name);
    }
});

test('each export and each of its members is described', () => {
    for (const [name, { symbol, instance }] of declared) {
        assert.ok(symbol.getDocumentationComment(typedChecker).length > 0, name);
        if (symbol.flags & ts.SymbolFlags.Function) continue;
        for (const [member, { declarations: all }] of publicMembers(typedChecker, instance))
            assert.ok(ts.getJSDocCommentsAndTags(all[0]).length > 0, `${name}.${member}`);
    }
});

// Whether a value is one of a type: by its kind, and among literals.
function isOf(value, type) {
    if (type.isUnion()) return type.types.some((one) => isOf(value, one));
    if (type.isStringLiteral()) return value === type.value;
    if (type.flags & ts.TypeFlags.BooleanLiteral) return String(value) === typedChecker.typeToString(type);
    if (type.flags & ts.TypeFlags.Null) return value === null;
    if (type.flags & ts.TypeFlags.Number) return typeof value === 'number';
    if (type.flags & ts.TypeFlags.String) return typeof value === 'string';
    if (type.getCallSignatures().length > 0) return typeof value === 'function';
    return typeof value === 'object' && value !== null && (value.constructor.name === type.symbol.name || value[`is${type.symbol.name}`] === true);
}

// A member of a live object: what it is, how it is called, and whether it may be set.
function assertMember(object, member, symbol) {
    const type = typedChecker.getTypeOfSymbol(symbol),
        kind = `${member}: ${typedChecker.typeToString(type)}`;
    assert.ok(member in object, member);
    assert.ok(isOf(object[member], type), `${kind} is ${object[member]}`);
    const [signature] = type.getCallSignatures();
    if (symbol.flags & ts.SymbolFlags.Method)
        assert.equal(object[member].length, signature.parameters.length, `${kind} takes ${object[member].length}`);
    const accessor = Object.getOwnPropertyDescriptor(Object.getPrototypeOf(object), member);
    if (!accessor?.get) return;
    const isReadonly = symbol.declarations.every(
        (one) => ts.getCombinedModifierFlags(one) & ts.ModifierFlags.Readonly || ts.isGetAccessor(one),
    );
    assert.equal(accessor.set === undefined, isReadonly, `${kind} may be set`);
}

test('the members of live objects are of their declared types', async (t) => {
    const { light, deliver } = await lightOfEnvironment();
    t.after(() => light.detach());
    deliver();
    await light.ready;
    // What makes light follow lamps needs a room, in a browser (lights.test.js).
    const lights = Promise.resolve([]);
    Object.defineProperty(light, 'lights', { value: lights });
    for (const [member, symbol] of typesOf('BakedLight')) assertMember(light, member, symbol);
    const material = new MeshStandardMaterial({ emissive: 'white', name: 'lamp' }),
        lamp = new Lamp(material, () => {});
    for (const [member, symbol] of typesOf('Lamp')) assertMember(lamp, member, symbol);
});

test('types.ts and the README\'s example compile', async () => {
    const text = await readFile(path('types.ts'), 'utf8');
    assert.ok(text.includes('@ts-expect-error'));
    const files = typed.getRootFileNames().map((name) => typed.getSourceFile(name)),
        found = files.flatMap((file) => [...typed.getSyntacticDiagnostics(file), ...typed.getSemanticDiagnostics(file)]);
    const messages = found.map(({ messageText, file, start }) => {
        const line = file ? file.getLineAndCharacterOfPosition(start).line + 1 : 0;
        return `${file?.fileName}:${line}: ${ts.flattenDiagnosticMessageText(messageText, ' ')}`;
    });
    assert.deepEqual(messages, []);
});
